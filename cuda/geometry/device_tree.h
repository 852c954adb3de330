#pragma once

#include <cfloat>
#include <vector>

#include "cuda/core/compaction.h"
#include "pliant/geometry/search/box_hierarchy.h"
#include "pliant/math/vector3.h"

namespace pliant {

/// Bounds of a box; the empty one overlaps nothing.
struct DeviceBox {
  double low[3], high[3];

  PLIANT_HOST_DEVICE static DeviceBox empty() {
    return {{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
  }
  PLIANT_HOST_DEVICE void extend(const DeviceBox& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = lesser(low[k], other.low[k]);
      high[k] = greater(high[k], other.high[k]);
    }
  }
  PLIANT_HOST_DEVICE bool overlaps(const DeviceBox& other) const {
    for (int k = 0; k < 3; ++k) {
      if (!(low[k] <= other.high[k] && other.low[k] <= high[k])) return false;
    }
    return true;
  }
  PLIANT_HOST_DEVICE bool is_finite() const {
    for (int k = 0; k < 3; ++k) {
      if (!(low[k] - low[k] == 0.0 && high[k] - high[k] == 0.0)) return false;
    }
    return true;
  }
};

/// As BoxHierarchy::Node.
struct alignas(16) DeviceNode {
  DeviceBox box;
  int first, count, right, unused;
};

/// A BoxHierarchy in the memory of an executor. Ranks are places in its order.
struct DeviceTreeView {
  const DeviceNode* nodes;
  const DeviceBox* boxes;  ///< by rank
  int size;                ///< of boxes

  /// Calls visit(rank) for each box that overlaps `box`, ascending.
  template <class Visit>
  PLIANT_HOST_DEVICE void for_each_overlapping(const DeviceBox& box, Visit& visit) const {
    constexpr int kDepth = 64;  // as BoxHierarchy
    if (size == 0) return;
    int stack[kDepth];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const int at = stack[--depth];
      const DeviceNode& node = nodes[at];
      if (!node.box.overlaps(box)) continue;
      for (int k = node.first; k < node.first + node.count; ++k) {
        if (boxes[k].overlaps(box)) visit(k);
      }
      if (node.count > 0) continue;
      stack[depth++] = node.right;
      stack[depth++] = at + 1;
    }
  }
};

/// Boxes of nodes that lie equally deep; those below are there already.
struct RefitNodes {
  DeviceNode* nodes;
  const DeviceBox* boxes;
  const int* level;
  PLIANT_HOST_DEVICE void operator()(int k) const {
    const int at = level[k];
    DeviceNode& node = nodes[at];
    node.box = DeviceBox::empty();
    for (int b = node.first; b < node.first + node.count; ++b) node.box.extend(boxes[b]);
    if (node.count > 0) return;
    node.box.extend(nodes[at + 1].box);
    node.box.extend(nodes[node.right].box);
  }
};

/// Keeps the shape of a tree and makes its boxes anew.
template <class Executor>
class DeviceTree {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  void take(Executor& executor, const BoxHierarchy& tree) {
    const std::vector<BoxHierarchy::Node>& nodes = tree.nodes();
    std::vector<DeviceNode> packed;
    for (const BoxHierarchy::Node& node : nodes) {
      packed.push_back({DeviceBox::empty(), node.first, node.count, node.right, 0});
    }
    const std::vector<int> by_level = levels_of(nodes);
    size_ = static_cast<int>(tree.order().size());
    if (size_ == 0) return;
    nodes_.resize(packed.size());
    by_level_.resize(by_level.size());
    boxes_.resize(tree.order().size());
    executor.upload(nodes_, packed.data(), packed.size());
    executor.upload(by_level_, by_level.data(), by_level.size());
    executor.synchronize();  // what is uploaded ends here
  }

  DeviceBox* boxes() { return boxes_.data(); }  ///< by rank, for a kernel to set
  void refit(Executor& executor) {
    for (std::size_t level = begins_.size() - 1; level-- > 0 && size_ > 0;) {
      executor.launch(begins_[level + 1] - begins_[level],
                      RefitNodes{nodes_.data(), boxes_.data(), by_level_.data() + begins_[level]});
    }
  }
  DeviceTreeView view() const { return {nodes_.data(), boxes_.data(), size_}; }

 private:
  /// Nodes by their depth; sets where each begins.
  std::vector<int> levels_of(const std::vector<BoxHierarchy::Node>& nodes) {
    std::vector<int> depths(nodes.size(), 0);
    std::vector<std::vector<int>> levels;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const auto depth = static_cast<std::size_t>(depths[n]);
      if (levels.size() <= depth) levels.resize(depth + 1);
      levels[depth].push_back(static_cast<int>(n));
      if (nodes[n].count > 0) continue;
      depths[n + 1] = depths[static_cast<std::size_t>(nodes[n].right)] = depths[n] + 1;
    }
    std::vector<int> all;
    begins_.assign(1, 0);
    for (const std::vector<int>& level : levels) {
      all.insert(all.end(), level.begin(), level.end());
      begins_.push_back(static_cast<int>(all.size()));
    }
    return all;
  }

  int size_ = 0;
  std::vector<int> begins_ = {0};  // of each depth's nodes, and the end
  Array<DeviceNode> nodes_;
  Array<int> by_level_;
  Array<DeviceBox> boxes_;
};

}  // namespace pliant
