#include "pliant/geometry/search/box_hierarchy.h"

#include <algorithm>
#include <numeric>

namespace pliant {
namespace {

using Bounds = BoxHierarchy::Box;

/// A box that overlaps nothing, in place of one with a bound that is no number.
Bounds sound(const Bounds& box) {
  return box.min().allFinite() && box.max().allFinite() ? box : Bounds();
}

}  // namespace

void BoxHierarchy::build(const std::vector<Bounds>& boxes) {
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.clear();
  if (!boxes.empty()) split(boxes, 0, static_cast<int>(boxes.size()));
  refit(boxes);
}

void BoxHierarchy::split(const std::vector<Bounds>& boxes, int first, int count) {
  const auto at = nodes_.size();
  nodes_.emplace_back();
  if (count <= kLeaf) {
    nodes_[at].first = first;
    nodes_[at].count = count;
    return;
  }
  const auto begin = order_.begin() + first;
  Bounds middles;
  for (auto i = begin; i != begin + count; ++i) {
    middles.extend(sound(boxes[static_cast<std::size_t>(*i)]).center());
  }
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const auto middle = [&](int i) {
    return sound(boxes[static_cast<std::size_t>(i)]).center()[axis];
  };
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](int a, int b) {
    return std::make_pair(middle(a), a) < std::make_pair(middle(b), b);
  });
  split(boxes, first, half);
  nodes_[at].right = static_cast<int>(nodes_.size());
  split(boxes, first + half, count - half);
}

void BoxHierarchy::refit(const std::vector<Bounds>& boxes) {
  boxes_.resize(order_.size());
  for (std::size_t k = 0; k < order_.size(); ++k) {
    boxes_[k] = sound(boxes[static_cast<std::size_t>(order_[k])]);
  }
  // Children come after their parents.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    node.box.setEmpty();
    for (int k = node.first; k < node.first + node.count; ++k) {
      node.box.extend(boxes_[static_cast<std::size_t>(k)]);
    }
    if (node.count > 0) continue;
    node.box.extend(nodes_[n + 1].box);
    node.box.extend(nodes_[static_cast<std::size_t>(node.right)].box);
  }
}

}  // namespace pliant
