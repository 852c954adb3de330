#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "pliant/geometry/search/point_hash.h"

namespace pliant {

struct Body;
class BodyPairs;

/// Looks for bodies that come near each other while nothing keeps them apart, now and then: whoever
/// wrote the scene surely did not mean them to pass through each other, but where it leaves out the
/// pair by name.
class NearBodies {
 public:
  /// Warns, in the report of the first of a pair and once for each pair, of bodies with vertices
  /// that are no farther apart than the vertices of a surface are. A look costs little, and of a
  /// scene of one body nothing.
  void look(std::uint64_t step, std::deque<Body>& bodies, const BodyPairs& pairs);
  /// All pairs are told anew.
  void reset() { told_.clear(); }
  /// Of these bodies, whatever was told: why they should be kept apart; empty: they are far apart,
  /// or kept.
  std::vector<std::string> find(const std::deque<Body>& bodies, const BodyPairs& pairs);

 private:
  struct Surface {
    Eigen::Matrix3Xd vertices;
    Eigen::AlignedBox3d box;
    double spacing = 0.0;  // of vertices [m]
  };
  static Surface surface_of(const Body& body);
  bool are_near(const Surface& a, const Surface& b);
  template <class Visit>
  void for_each_near_pair(const std::deque<Body>& bodies, const BodyPairs& pairs,
                          const Visit& visit);

  std::vector<std::pair<std::size_t, std::size_t>> told_;
  PointHash hash_;
};

}  // namespace pliant
