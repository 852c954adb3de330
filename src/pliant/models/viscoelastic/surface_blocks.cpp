#include "pliant/models/viscoelastic/surface_blocks.h"

#include <algorithm>
#include <iterator>

namespace pliant {
namespace {

// Bits of a cell's number along each axis, which begin with -2.
constexpr int kBits = 21;
constexpr std::uint64_t kAlongX = 1;
constexpr std::uint64_t kAlongY = std::uint64_t{1} << kBits;
constexpr std::uint64_t kAlongZ = std::uint64_t{1} << (2 * kBits);

std::uint64_t key_of(const SurfaceBlocks::Cell& cell) {
  return static_cast<std::uint64_t>(cell[0] + 2) * kAlongX +
         static_cast<std::uint64_t>(cell[1] + 2) * kAlongY +
         static_cast<std::uint64_t>(cell[2] + 2) * kAlongZ;
}

SurfaceBlocks::Cell cell_of(std::uint64_t key) {
  const std::uint64_t mask = kAlongY - 1;
  return {static_cast<int>(key & mask) - 2, static_cast<int>((key >> kBits) & mask) - 2,
          static_cast<int>(key >> (2 * kBits)) - 2};
}

}  // namespace

void SurfaceBlocks::dilate(std::uint64_t offset) {
  below_ = above_ = keys_;
  for (std::uint64_t& key : below_) key -= offset;
  for (std::uint64_t& key : above_) key += offset;
  both_.clear();
  std::set_union(below_.begin(), below_.end(), above_.begin(), above_.end(),
                 std::back_inserter(both_));
  below_.clear();
  std::set_union(both_.begin(), both_.end(), keys_.begin(), keys_.end(),
                 std::back_inserter(below_));
  keys_.swap(below_);
}

void SurfaceBlocks::build(const std::vector<Cell>& marked, int detail) {
  detail_ = detail;
  keys_.clear();
  for (const Cell& cell : marked) keys_.push_back(key_of(cell));
  dilate(kAlongX);
  dilate(kAlongY);
  dilate(kAlongZ);
  cells_.clear();
  for (std::uint64_t key : keys_) cells_.push_back(cell_of(key));
  find_next();
}

int SurfaceBlocks::find(const Cell& cell) const {
  const auto found = std::lower_bound(keys_.begin(), keys_.end(), key_of(cell));
  const bool is_there = found != keys_.end() && *found == key_of(cell);
  return is_there ? static_cast<int>(found - keys_.begin()) : -1;
}

void SurfaceBlocks::find_next() {
  next_.resize(keys_.size());
  for (int n = 0; n < 8; ++n) {
    const std::uint64_t offset = static_cast<std::uint64_t>(n & 1) * kAlongX +
                                 static_cast<std::uint64_t>(n >> 1 & 1) * kAlongY +
                                 static_cast<std::uint64_t>(n >> 2 & 1) * kAlongZ;
    // Keys ascend, so that what is looked for does as well.
    std::size_t found = 0;
    for (std::size_t b = 0; b < keys_.size(); ++b) {
      while (found < keys_.size() && keys_[found] < keys_[b] + offset) ++found;
      const bool is_there = found < keys_.size() && keys_[found] == keys_[b] + offset;
      next_[b][at(n)] = is_there ? static_cast<int>(found) : -1;
    }
  }
}

SurfaceBlocks::Node SurfaceBlocks::node(int block, int x, int y, int z) const {
  const int beyond_x = x == detail_ ? 1 : 0, beyond_y = y == detail_ ? 1 : 0;
  const int beyond_z = z == detail_ ? 1 : 0;
  return {next_[at(block)][at(beyond_x | beyond_y << 1 | beyond_z << 2)],
          (x - beyond_x * detail_) +
              detail_ * ((y - beyond_y * detail_) + detail_ * (z - beyond_z * detail_))};
}

}  // namespace pliant
