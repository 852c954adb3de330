#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace pliant {

/// A binary tree over boxes whose shape is chosen once and whose boxes follow what moves: to find
/// those that overlap a given one. Boxes of neighbours should stay neighbours, as those of a mesh
/// do.
class BoxHierarchy {
 public:
  using Box = Eigen::AlignedBox3d;
  struct Node {
    Box box;
    int first = 0, count = 0;  ///< of the leaf's boxes in order(); count 0: an inner node
    int right = 0;             ///< the left child comes next
  };

  /// Splits where the middles of the boxes lie apart the most. Of none: nothing is ever found.
  void build(const std::vector<Box>& boxes);
  /// The same number of boxes at other places; empty ones and such that are not finite overlap
  /// nothing.
  void refit(const std::vector<Box>& boxes);

  /// Calls visit(index) for each box that overlaps `box`, in an order that depends on build()
  /// alone. Safe to call from many threads.
  template <class Visit>
  void for_each_overlapping(const Box& box, const Visit& visit) const;

  /// Children come after their parents.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Numbers of the boxes, in which for_each_overlapping() comes to them.
  const std::vector<int>& order() const { return order_; }

 private:
  static constexpr int kLeaf = 4;    // boxes
  static constexpr int kDepth = 64;  // more than halving ever needs

  void split(const std::vector<Box>& boxes, int first, int count);

  std::vector<int> order_;
  std::vector<Box> boxes_;  // in the order of order_
  std::vector<Node> nodes_;
};

template <class Visit>
void BoxHierarchy::for_each_overlapping(const Box& box, const Visit& visit) const {
  if (nodes_.empty()) return;
  int stack[kDepth];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int at = stack[--depth];
    const Node& node = nodes_[static_cast<std::size_t>(at)];
    if (!node.box.intersects(box)) continue;
    for (int k = node.first; k < node.first + node.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (boxes_[i].intersects(box)) visit(order_[i]);
    }
    if (node.count > 0) continue;
    stack[depth++] = node.right;
    stack[depth++] = at + 1;
  }
}

}  // namespace pliant
