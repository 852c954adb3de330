#include "pliant/geometry/mesh/vertex_welder.h"

#include <cstring>

namespace pliant {

int VertexWelder::add(const Eigen::Vector3d& p) {
  const Eigen::Vector3d position = p.array() + 0.0;  // -0 becomes 0
  // Bits rather than numbers, so that NaN equals itself.
  Key key;
  std::memcpy(key.data(), position.data(), sizeof(key));
  const auto [entry, is_new] = index_.emplace(key, static_cast<int>(positions_.size()));
  if (is_new) positions_.push_back(position);
  return entry->second;
}

Eigen::Matrix3Xd VertexWelder::vertices() const {
  Eigen::Matrix3Xd result(3, positions_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) result.col(i) = positions_[i];
  return result;
}

std::size_t VertexWelder::Hash::operator()(const Key& key) const {
  std::uint64_t hash = 0;
  for (const std::uint64_t bits : key) {
    hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;  // 2^64 / golden ratio
    hash ^= hash >> 32;
  }
  return hash;
}

}  // namespace pliant
