#ifndef PLIANT_GEOMETRY_VERTEX_WELDER_H_
#define PLIANT_GEOMETRY_VERTEX_WELDER_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pliant {

// Joins vertices at exactly the same position. (Joining by a tolerance swallows small objects.)
class VertexWelder {
 public:
  // The index of the vertex at p, new or known: indices count up in order of first appearance.
  int add(const Eigen::Vector3d& p);

  Eigen::Matrix3Xd vertices() const;

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };

  std::unordered_map<Key, int, Hash> index_;
  std::vector<Eigen::Vector3d> positions_;
};

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_VERTEX_WELDER_H_
