#pragma once

#include <cstring>
#include <utility>
#include <vector>

#include "cuda/effects/sheet_collector.h"
#include "cuda/effects/sheet_near_pairs.h"
#include "pliant/core/columns.h"
#include "pliant/core/step/timer.h"

namespace pliant {

/// SheetTreeSearch by an executor: the same trees, candidates, state and arithmetic, so that it
/// finds the same, in the same order and to the bit. Positions go up, what was found comes down.
template <class Executor>
class DeviceSheetSearch final : public SheetSearch {
 public:
  explicit DeviceSheetSearch(const SheetTreeSearch& cpu);

  SheetNearPairs find(const Positions& start, const Positions& end) override;
  bool limit_displacement(const Particles& particles, Positions& x, SheetNearPairs& found) override;

  SheetSearchCost cost() const override { return cost_; }

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  void upload(const Positions& x, Staged<Double3>& staged, Array<Double3>& array);
  void clear_tally() { executor_.launch(1, sheet_kernels::ClearTally{tally_.data()}); }
  SheetTally tally() {
    SheetTally tally;
    executor_.download(&tally, tally_, 1);
    return tally;
  }
  const sheet_kernels::DisplacementSums* sum_displacements(const Double3* start,
                                                           const Double3* end);
  /// Whether candidates have to be collected anew.
  bool follow(const Double3* start, const Double3* end);
  void search(const Double3* start, const Double3* end);
  void collect();
  void look();
  SheetNearPairs gather();
  bool is_seen();
  /// Whether a pair passes on the paths to to_.
  bool shorten(bool is_first, bool stop);
  void move_back(int round);

  Executor executor_;
  double least_thickness_, margin_;  // [m]
  int vertices_;
  SheetCollector<Executor> collector_;
  // The running step. Ends are without the mean motion.
  Array<Double3> from_, to_, wanted_, start_, end_, collected_start_, collected_end_;
  Array<double> slacks_;
  Array<sheet_kernels::DisplacementSums> sums_[2];
  Array<SheetTally> tally_;
  sheet_kernels::SheetPlaces places_;
  bool is_first_ = true;
  double path_ = 0.0, motion_ = 0.0;  // as SheetTreeSearch's [m]
  // Pairs that may come near, those that have to be looked at, those near, those for the host.
  SheetCandidates candidates_{};
  Compaction<Executor> awake_, near_places_, found_places_;
  Array<SheetNearPair> near_, found_;
  SheetSearchCost cost_;
  // How far vertices may go.
  Array<double> shares_;
  Array<SharedExtreme> cuts_;
  Array<unsigned char> fixed_;
  Staged<Double3> staged_start_, staged_end_;
  Staged<unsigned char> staged_fixed_;
  Staged<SheetNearPair> staged_found_;
};

template <class Executor>
DeviceSheetSearch<Executor>::DeviceSheetSearch(const SheetTreeSearch& cpu)
    : least_thickness_(cpu.least_thickness()),
      margin_(cpu.margin()),
      vertices_(cpu.mesh().vertices()),
      collector_(executor_, cpu) {
  const auto n = static_cast<std::size_t>(vertices_);
  // The first start is counted from the sheet at rest, as on the CPU.
  start_.resize(n);
  if (n > 0) executor_.upload(start_, cpu.mesh().rest.data(), n);
  for (Array<Double3>* array :
       {&from_, &to_, &wanted_, &end_, &collected_start_, &collected_end_}) {
    array->resize(n);
  }
  slacks_.resize(n);
  shares_.resize(n);
  cuts_.resize(n);
  fixed_.resize(n);
  for (auto& sums : sums_) sums.resize(n / kSumRun + 1);
  tally_.resize(1);
  places_ = {start_.data(), end_.data(), collected_start_.data(), collected_end_.data(),
             slacks_.data()};
  executor_.synchronize();
}

template <class Executor>
void DeviceSheetSearch<Executor>::upload(const Positions& x, Staged<Double3>& staged,
                                         Array<Double3>& array) {
  staged.resize(static_cast<std::size_t>(vertices_));
  const Double3* from = places_in(x);
  parallel_for(0, vertices_, kColumnGrain, [&](int begin, int end) {
    std::memcpy(staged.data() + begin, from + begin,
                static_cast<std::size_t>(end - begin) * sizeof(Double3));
  });
  executor_.upload(array, staged.data(), staged.size());
}

template <class Executor>
SheetNearPairs DeviceSheetSearch<Executor>::find(const Positions& start, const Positions& end) {
  if (vertices_ == 0) return {};
  const Timer timer;
  upload(start, staged_start_, from_);
  upload(end, staged_end_, to_);
  cost_.transfers += timer.seconds();
  search(from_.data(), to_.data());
  return gather();
}

template <class Executor>
void DeviceSheetSearch<Executor>::search(const Double3* start, const Double3* end) {
  const Timer following;
  const bool is_far = follow(start, end);
  cost_.follow += following.seconds();
  const Timer collecting;
  if (is_far) collect();
  cost_.collect += collecting.seconds();
  const Timer looking;
  look();
  cost_.look += looking.seconds();
}

template <class Executor>
const sheet_kernels::DisplacementSums* DeviceSheetSearch<Executor>::sum_displacements(
    const Double3* start, const Double3* end) {
  int size = (vertices_ + kSumRun - 1) / kSumRun, own = 0;
  executor_.launch(size, sheet_kernels::SumDisplacements{start_.data(), start, end, vertices_,
                                                         sums_[own].data()});
  for (; size > 1; own = 1 - own) {
    const int runs = (size + kSumRun - 1) / kSumRun;
    executor_.launch(runs, sheet_kernels::SumSums{sums_[own].data(), size, sums_[1 - own].data()});
    size = runs;
  }
  return sums_[own].data();
}

template <class Executor>
bool DeviceSheetSearch<Executor>::follow(const Double3* start, const Double3* end) {
  clear_tally();
  const sheet_kernels::DisplacementSums* sum = sum_displacements(start, end);
  executor_.launch(vertices_,
                   sheet_kernels::Follow{start, end, places_, sum, static_cast<double>(vertices_),
                                         is_first_, tally_.data()});
  const SheetTally tally = this->tally();
  path_ += tally.path.value();
  motion_ = tally.motion.value();
  return std::exchange(is_first_, false) || tally.is_far != 0;
}

template <class Executor>
void DeviceSheetSearch<Executor>::collect() {
  ++cost_.collections;
  candidates_ = collector_.collect(executor_, places_, tally_);
  cost_.candidates = candidates_.pairs;
}

template <class Executor>
void DeviceSheetSearch<Executor>::look() {
  using namespace sheet_kernels;
  const SheetLook look = {candidates_, start_.data(), end_.data(), path_, motion_, margin_};
  executor_.launch(candidates_.pairs, WakeCandidates{look, awake_.flags(candidates_.pairs)});
  cost_.awake = awake_.run(executor_);
  executor_.launch(cost_.awake,
                   LookAtCandidates{look, awake_.list(), near_places_.flags(cost_.awake)});
  cost_.near = near_places_.run(executor_);
  grow(near_, static_cast<std::size_t>(cost_.near));
  executor_.launch(cost_.near, GatherNear{look, awake_.list(), near_places_.list(), near_.data()});
}

template <class Executor>
SheetNearPairs DeviceSheetSearch<Executor>::gather() {
  using namespace sheet_kernels;
  const Timer timer;
  executor_.launch(cost_.near,
                   KeepFirst{near_.data(), cost_.near, found_places_.flags(cost_.near)});
  const int count = found_places_.run(executor_);
  grow(found_, static_cast<std::size_t>(count));
  executor_.launch(count, GatherFound{near_.data(), found_places_.list(), found_.data()});
  const auto size = static_cast<std::size_t>(count);
  grow(staged_found_, size);
  if (count > 0) executor_.download(staged_found_.data(), found_, size);
  cost_.gather += timer.seconds();
  return {staged_found_.data(), size};
}

template <class Executor>
bool DeviceSheetSearch<Executor>::is_seen() {
  clear_tally();
  const double most = sheet_pairs::kSeen * (least_thickness_ + margin_);
  executor_.launch(vertices_,
                   sheet_kernels::LookForUnseen{to_.data(), end_.data(), most, tally_.data()});
  return tally().is_unseen == 0;
}

template <class Executor>
bool DeviceSheetSearch<Executor>::shorten(bool is_first, bool stop) {
  using namespace sheet_kernels;
  const SheetShares shares = {shares_.data(), cuts_.data()};
  clear_tally();
  executor_.launch(vertices_, BeginShares{shares, is_first});
  executor_.launch(cost_.near,
                   Shorten{near_.data(), start_.data(), to_.data(), stop, shares, tally_.data()});
  return tally().passes != 0;
}

template <class Executor>
void DeviceSheetSearch<Executor>::move_back(int round) {
  using namespace sheet_kernels;
  executor_.launch(vertices_, MoveBack{start_.data(),
                                       wanted_.data(),
                                       fixed_.data(),
                                       {shares_.data(), cuts_.data()},
                                       round == sheet_pairs::kStopped,
                                       to_.data()});
}

template <class Executor>
bool DeviceSheetSearch<Executor>::limit_displacement(const Particles& particles, Positions& x,
                                                     SheetNearPairs& found) {
  using namespace sheet_pairs;
  if (vertices_ == 0) return true;
  upload(x, staged_end_, to_);
  if (!is_seen()) search(start_.data(), to_.data());
  if (!shorten(true, false)) return true;
  executor_.launch(vertices_, sheet_kernels::CopyPlaces{to_.data(), wanted_.data()});
  staged_fixed_.resize(static_cast<std::size_t>(vertices_));
  for (int i = 0; i < vertices_; ++i) {
    staged_fixed_[static_cast<std::size_t>(i)] = particles.is_fixed(i) ? 1 : 0;
  }
  executor_.upload(fixed_, staged_fixed_.data(), staged_fixed_.size());
  for (int round = 1; round <= kStopped; ++round) {
    move_back(round);
    search(start_.data(), to_.data());
    if (!shorten(false, round >= kShortened)) break;
  }
  search(to_.data(), wanted_.data());
  found = gather();
  executor_.download(staged_end_.data(), to_, staged_end_.size());
  std::memcpy(x.data(), staged_end_.data(), staged_end_.size() * sizeof(Double3));
  return false;
}

}  // namespace pliant
