#include "cuda/solvers/blocks/block_borders.h"

#include <algorithm>

#include "pliant/math/error.h"

namespace pliant {

BlockBorders::BlockBorders(int block, std::vector<std::vector<int>> read) : block_(block) {
  constexpr int kMost = 0xffff;
  for (std::size_t b = 0; b < read.size(); ++b) {
    std::vector<int>& places = read[b];
    const int own = static_cast<int>(b) * block;
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    std::copy_if(places.begin(), places.end(), std::back_inserter(places_),
                 [&](int place) { return place < own || place >= own + block; });
    begins_.push_back(static_cast<int>(places_.size()));
    most_ = std::max(most_, begins_[b + 1] - begins_[b]);
  }
  if (block_ + most_ > kMost) {
    throw InputError("a particle of this body has more neighbours than a GPU's block can number");
  }
}

unsigned short BlockBorders::number(int b, int place) const {
  if (place / block_ == b) return static_cast<unsigned short>(place - b * block_);
  const auto begin = places_.begin() + begins_[static_cast<std::size_t>(b)];
  const auto end = places_.begin() + begins_[static_cast<std::size_t>(b) + 1];
  return static_cast<unsigned short>(block_ + (std::lower_bound(begin, end, place) - begin));
}

void BlockBorders::append(const BlockBorders& other, int blocks, int first_place) {
  block_ = std::max(block_, other.block_);
  most_ = std::max(most_, other.most_);
  const int first = begins_.back();
  for (std::size_t b = 1; b <= static_cast<std::size_t>(blocks); ++b) {
    begins_.push_back(first + (b < other.begins_.size() ? other.begins_[b] : 0));
  }
  for (int place : other.places_) places_.push_back(first_place + place);
}

}  // namespace pliant
