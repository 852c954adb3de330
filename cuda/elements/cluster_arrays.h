#pragma once

#include <algorithm>

#include "cuda/elements/cluster_table.h"

namespace pliant {

/// Clusters in the memory of an executor.
template <class Executor>
class ClusterArrays {
 public:
  static constexpr int kChunk = 128;  ///< members that one thread sums

  void bind(Executor& executor, const ClusterList& list, int places, ClustersView& view) {
    view = {};
    if (list.size() == 0) return;
    const ClusterTable table = lay_out(list, places, kChunk);
    view.clusters = table.clusters;
    view.small = table.small;
    view.chunks = table.chunks;
    view.begins = put(executor, begins_, table.begins);
    view.members = put(executor, members_, table.members);
    view.origins = put(executor, origins_, table.origins);
    view.owners = put(executor, owners_, table.owners);
    view.first_chunks = put(executor, first_chunks_, table.first_chunks);
    view.loads = put(executor, loads_, table.loads);
    view.rest = put(executor, rest_, table.rest);
    view.stiffness = put(executor, stiffness_, table.stiffness);
    put(executor, motions_, table.motions);
    view.motions = motions_.data();
    view.pull_begins = put(executor, pull_begins_, table.pull_begins);
    view.pull_clusters = put(executor, pull_clusters_, table.pull_clusters);
    view.pull_loads = put(executor, pull_loads_, table.pull_loads);
    order_ = table.order;
    spins_.resize(list.is_oriented ? ClustersView::kSpin * order_.size() : 0);
    if (list.is_oriented) view.spins = spins_.data();
    sums_.resize(static_cast<std::size_t>(table.chunks - table.small) * ClusterSums<float>::kSize);
    view.sums = sums_.data();
    executor.synchronize();  // the table is gone after this
  }

  /// What list_spins() tells of the list that was bound.
  void set_spins(Executor& executor, const std::vector<float>& spins) {
    constexpr std::size_t kSpin = ClustersView::kSpin;
    ordered_spins_.resize(spins.size());
    for (std::size_t n = 0; n < order_.size(); ++n) {
      const auto from = spins.begin() + static_cast<std::ptrdiff_t>(kSpin) * order_[n];
      std::copy_n(from, kSpin, ordered_spins_.begin() + static_cast<std::ptrdiff_t>(kSpin * n));
    }
    executor.upload(spins_, ordered_spins_.data(), ordered_spins_.size());
    executor.synchronize();
  }

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  static const T* put(Executor& executor, Array<T>& array, const std::vector<T>& values) {
    array.resize(values.size());
    if (values.empty()) return nullptr;
    executor.upload(array, values.data(), values.size());
    return array.data();
  }

  Array<int> begins_, members_, origins_, owners_, first_chunks_, pull_begins_, pull_clusters_;
  Array<Float4> loads_, pull_loads_;
  Array<Fixed> rest_;
  Array<ClusterMotion> motions_;
  Array<float> stiffness_, sums_, spins_;
  std::vector<int> order_;            // of the list
  std::vector<float> ordered_spins_;  // those in the executor's memory
};

}  // namespace pliant
