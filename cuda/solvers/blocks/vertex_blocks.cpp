#include "cuda/solvers/blocks/vertex_blocks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace pliant {
namespace {

class Bisection {
 public:
  Bisection(const Positions& x, int block) : x_(x), block_(block) {}

  void split(std::vector<int>::iterator begin, std::vector<int>::iterator end) const {
    const auto count = end - begin;
    if (count <= block_) {
      std::sort(begin, end);
      return;
    }
    Eigen::AlignedBox3d box;
    for (auto i = begin; i != end; ++i) box.extend(x_.col(*i));
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto blocks = (count + block_ - 1) / block_;
    const auto middle = begin + blocks / 2 * block_;
    std::nth_element(begin, middle, end, [&](int a, int b) {
      return std::make_pair(x_(axis, a), a) < std::make_pair(x_(axis, b), b);
    });
    split(begin, middle);
    split(middle, end);
  }

 private:
  const Positions& x_;
  std::ptrdiff_t block_;
};

}  // namespace

BlockPlan plan_blocks(int particles) {
  constexpr int kSmallBlock = 96, kLargeBlock = 128;
  if (particles >= kLargeBody) return {kLargeBlock, 2};
  // Blocks of a solid keep a multiprocessor each; 132 of these are on the GPUs that the sizes were
  // chosen on, and results are to be those of any other GPU.
  constexpr int kProcessors = 132;
  const bool needs_large =
      particles > kProcessors * kSmallBlock && particles <= kProcessors * kLargeBlock;
  return {needs_large ? kLargeBlock : kSmallBlock, 1};
}

std::vector<int> order_in_blocks(const Positions& x, int block) {
  std::vector<int> order(static_cast<std::size_t>(x.cols()));
  std::iota(order.begin(), order.end(), 0);
  Bisection(x, block).split(order.begin(), order.end());
  return order;
}

}  // namespace pliant
