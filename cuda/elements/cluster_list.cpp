#include "cuda/elements/cluster_list.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "cuda/elements/cluster_forces.h"
#include "cuda/elements/common_rest.h"
#include "pliant/elements/clusters/cluster_source.h"

namespace pliant {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// The member nearest to the middle.
int middle_member(const ClusterShapes& shapes, const ClusterShapes::Shape& shape) {
  int best = shape.begin;
  for (int k = shape.begin; k < shape.end; ++k) {
    if (shapes.member(k).rest.squaredNorm() < shapes.member(best).rest.squaredNorm()) best = k;
  }
  return best;
}

Float4 load_of(const ClusterShapes::Member& m) {
  return {static_cast<float>(m.rest[0]), static_cast<float>(m.rest[1]),
          static_cast<float>(m.rest[2]), static_cast<float>(m.mass)};
}

}  // namespace

bool is_cluster_set(const ElementSet& set, const ClusterSet*& clusters) {
  clusters = nullptr;
  bool are_clusters = false;
  clusters = clusters_of(set, are_clusters);
  return are_clusters;
}

ClusterList list_clusters(const ClusterSet& set, const std::vector<int>& place, int places) {
  const ClusterShapes& shapes = set.shapes();
  std::vector<int> middles;
  for (int c = 0; c < shapes.size(); ++c) middles.push_back(middle_member(shapes, shapes.shape(c)));
  // Neighbours in space side by side, those of many members last.
  std::vector<int> order(at(shapes.size()));
  std::iota(order.begin(), order.end(), 0);
  const auto middle_place = [&](int c) {
    return place[at(shapes.member(middles[at(c)]).particle)];
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::make_pair(middle_place(a), a) < std::make_pair(middle_place(b), b);
  });
  ClusterList list;
  for (int c : order) {
    const ClusterShapes::Shape& shape = shapes.shape(c);
    const int first = static_cast<int>(list.members.size());
    for (int k = shape.begin; k < shape.end; ++k) {
      list.members.push_back(place[at(shapes.member(k).particle)]);
      list.loads.push_back(load_of(shapes.member(k)));
    }
    const int middle = first + middles[at(c)] - shape.begin;
    std::swap(list.members[at(first)], list.members[at(middle)]);
    std::swap(list.loads[at(first)], list.loads[at(middle)]);
    list.begins.push_back(static_cast<int>(list.members.size()));
    list.stiffness.push_back(static_cast<float>(shape.stiffness));
  }
  list.numbers = std::move(order);
  list.is_oriented = !set.turned_spins().empty();
  list.quanta.assign(at(list.size()), 1.0f);
  double quantum = 1.0;
  if (find_common_rest(shapes, place, places, list.rest, quantum)) {
    list.quanta.assign(at(list.size()), static_cast<float>(quantum));
  }
  return list;
}

void list_spins(const ClusterSet& set, const ClusterList& list, std::vector<float>& spins) {
  const std::vector<Eigen::Matrix3d>& turned = set.turned_spins();
  const std::size_t first = spins.size() / ClustersView::kSpin;
  spins.resize(spins.size() + ClustersView::kSpin * at(set.size()), 0.0f);
  if (turned.empty()) return;
  float* next = spins.data() + ClustersView::kSpin * first;
  for (std::size_t c = first; c < first + at(set.size()); ++c) {
    const Eigen::Matrix3d& spin = turned[at(list.numbers[c])];
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) *next++ = static_cast<float>(spin(r, k));
    }
  }
}

void append_clusters(const ClusterList& from, int first_place, int places, ClusterList& to) {
  const bool had_any = to.size() > 0;
  const bool is_common = (from.size() == 0 || !from.rest.empty()) && (!had_any || !to.rest.empty());
  const int first = to.begins.back();
  for (std::size_t c = 1; c < from.begins.size(); ++c) to.begins.push_back(first + from.begins[c]);
  for (int i : from.members) to.members.push_back(first_place + i);
  to.loads.insert(to.loads.end(), from.loads.begin(), from.loads.end());
  to.stiffness.insert(to.stiffness.end(), from.stiffness.begin(), from.stiffness.end());
  to.quanta.insert(to.quanta.end(), from.quanta.begin(), from.quanta.end());
  to.numbers.insert(to.numbers.end(), from.numbers.begin(), from.numbers.end());
  to.is_oriented = to.is_oriented || from.is_oriented;
  if (!is_common) {
    to.rest.clear();
    return;
  }
  if (to.size() == 0) return;
  to.rest.resize(at(first_place), Fixed{0, 0, 0, 0.0f});
  to.rest.insert(to.rest.end(), from.rest.begin(), from.rest.end());
  to.rest.resize(at(first_place + places), Fixed{0, 0, 0, 0.0f});
}

}  // namespace pliant
