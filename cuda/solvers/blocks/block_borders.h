#pragma once

#include <vector>

namespace pliant {

/// The places that blocks of particles read besides their own: each block's own come first, then
/// its border, so that a number within the block says who is meant and fits 16 bits.
class BlockBorders {
 public:
  BlockBorders() = default;
  /// `read`: the places that each block reads, in any order, its own and repeated ones among them.
  /// Throws InputError where a block reads more than 16 bits can number.
  BlockBorders(int block, std::vector<std::vector<int>> read);

  bool empty() const { return places_.empty(); }
  int block() const { return block_; }
  int most() const { return most_; }  ///< places of the longest border
  /// The first place of each block's border, and the end.
  const std::vector<int>& begins() const { return begins_; }
  const std::vector<int>& places() const { return places_; }
  /// Number of `place` within block `b`, which reads it.
  unsigned short number(int b, int place) const;
  /// Those of another system of so many blocks, whose places begin at `first_place`, behind these.
  void append(const BlockBorders& other, int blocks, int first_place);

 private:
  int block_ = 0, most_ = 0;
  std::vector<int> begins_ = {0};
  std::vector<int> places_;  // of each block ascending
};

}  // namespace pliant
