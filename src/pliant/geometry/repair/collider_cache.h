#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/geometry/repair/mesh_collider.h"

namespace pliant {

/// Names what a collider is made from: its inputs, hashed by XXH3 with 128 bits.
using ColliderKey = std::array<std::uint64_t, 2>;

/// The key of a mesh's bytes (or anything that tells it), with what else decides the result.
ColliderKey collider_key(std::string_view mesh, double scale_x, double scale_y, double scale_z,
                         const ColliderOptions& options);

/// Colliders that were made before, a file each, in one folder. A file appears complete or not at
/// all; of those of a moment ago several processes may have made the same. Together they take up at
/// most 1 GiB: what has not been used the longest is removed first.
class ColliderCache {
 public:
  /// $XDG_CACHE_HOME/pliant, or ~/.cache/pliant; where neither variable is an absolute path,
  /// nothing is kept.
  ColliderCache();
  /// "": nothing is kept.
  explicit ColliderCache(std::string folder, std::uint64_t most_bytes = std::uint64_t{1} << 30);

  const std::string& folder() const { return folder_; }

  /// What was kept. `problem` says why what is there was not used (a file that is broken, or of
  /// something else); it stays as it is where there simply is none.
  std::optional<MeshCollider> read(const ColliderKey& key, std::string& problem) const;

  /// Keeps one. `problem` says why that was not possible; it is no error.
  void write(const ColliderKey& key, const MeshCollider& collider, std::string& problem) const;

 private:
  std::string path(const ColliderKey& key) const;
  void remove_oldest() const;

  std::string folder_;
  std::uint64_t most_bytes_;
};

}  // namespace pliant
