#pragma once

#include <vector>

#include "cuda/core/upload.h"
#include "cuda/solvers/device_step.h"
#include "cuda/solvers/resident_run/balance_search.h"
#include "cuda/solvers/resident_run/balance_sums.h"

namespace pliant {

/// The momentum of connected components in a resident run, in the memory of an executor.
template <class Executor>
class DeviceBalance {
 public:
  /// The components' places and where each begins, with the end; `resident` learns of them. Returns
  /// whether they are others than before.
  bool bind(DeviceStep<Executor>& step, const std::vector<int>& members,
            const std::vector<int>& begins, ResidentArrays& resident);
  /// Before the iterations: moves their start to where rigid components would end. Of sweeps alone,
  /// which are few: other iterations get nothing of it.
  void launch_start(DeviceStep<Executor>& step, const ResidentArrays& resident);
  /// After them: balances the impulses, and finds what velocities lack.
  void launch_end(DeviceStep<Executor>& step, const ResidentArrays& resident);

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;
  // As MomentumBalance: compliance of contacts as a share of a particle's own answer to a force.
  static constexpr float kSoft = 1.0f, kHard = 0.25f;
  // What is left out of balance, as a share of all forces.
  static constexpr double kRough = 1e-2, kAccuracy = 1e-5;
  // Trials that all runs take part in; few searches need more, and a block of its own makes them.
  // One that goes on from the one before needs fewer. Of many runs a block would take a tenth of a
  // millisecond and more for each trial, and a trial that nobody needs takes three microseconds.
  static constexpr int kManyRuns = 32, kManyTimes = 10;
  static constexpr int kStartTrials = 4, kFirstTrials = 6, kSecondTrials = 4;

  void upload_components(DeviceStep<Executor>& step);
  void launch_sums(DeviceStep<Executor>& step, const ResidentArrays& resident, Fixed* x,
                   SumMembers::Stage stage);
  void launch_search(DeviceStep<Executor>& step, const BalanceContacts& contacts, bool starts,
                     int trials);

  BalanceComponents view_;
  bool is_large_ = false;  // some component has many runs
  std::vector<int> members_, begins_;
  Array<int> member_places_, member_begins_, run_begins_, of_run_, component_;
  Array<int> touched_, touched_count_;
  Array<double> sums_, answers_;
  Array<MotionSearch> searches_;
  Array<Float4> rows_;
  Array<BalanceMotion> missed_;
  Array<Fixed> ended_;
};

template <class Executor>
bool DeviceBalance<Executor>::bind(DeviceStep<Executor>& step, const std::vector<int>& members,
                                   const std::vector<int>& begins, ResidentArrays& resident) {
  if (members == members_ && begins == begins_) return false;
  members_ = members;
  begins_ = begins;
  view_ = {};
  resident.component = nullptr;
  if (members.empty()) return true;
  upload_components(step);
  const auto n = static_cast<std::size_t>(step.particles());
  const std::size_t slots = n * static_cast<std::size_t>(resident.slots);
  if (ended_.size() != n) ended_.resize(n);
  if (rows_.size() != slots) rows_.resize(slots);
  view_.rows = rows_.data();
  resident.component = component_.data();
  resident.ended = ended_.data();
  resident.missed = missed_.data();
  return true;
}

template <class Executor>
void DeviceBalance<Executor>::upload_components(DeviceStep<Executor>& step) {
  constexpr int kRun = BalanceComponents::kRun;
  is_large_ = false;
  std::vector<int> run_begins(1, 0), of_run,
      of_place(static_cast<std::size_t>(step.particles()), -1);
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    const int component = static_cast<int>(c);
    const int runs = (begins_[c + 1] - begins_[c] + kRun - 1) / kRun;
    is_large_ = is_large_ || runs > kManyRuns;
    run_begins.push_back(run_begins.back() + runs);
    of_run.insert(of_run.end(), static_cast<std::size_t>(runs), component);
    for (int k = begins_[c]; k < begins_[c + 1]; ++k) {
      of_place[static_cast<std::size_t>(members_[static_cast<std::size_t>(k)])] = component;
    }
  }
  Executor& executor = step.executor();
  upload_all(executor, member_places_, members_);
  upload_all(executor, member_begins_, begins_);
  upload_all(executor, run_begins_, run_begins);
  upload_all(executor, of_run_, of_run);
  upload_all(executor, component_, of_place);
  executor.synchronize();  // what was uploaded may go
  sums_.resize(of_run.size() * BalanceComponents::kNumbers);
  touched_.resize(of_run.size() * kRun);
  touched_count_.resize(of_run.size());
  answers_.resize(of_run.size() * SumAnswers::kNumbers);
  missed_.resize(begins_.size() - 1);
  searches_.resize(begins_.size() - 1);
  view_.count = static_cast<int>(begins_.size()) - 1;
  view_.runs = static_cast<int>(of_run.size());
  view_.members = member_places_.data();
  view_.begins = member_begins_.data();
  view_.run_begins = run_begins_.data();
  view_.of_run = of_run_.data();
  view_.sums = sums_.data();
  view_.touched = touched_.data();
  view_.touched_count = touched_count_.data();
  view_.answers = answers_.data();
  view_.searches = searches_.data();
  view_.missed = missed_.data();
}

template <class Executor>
void DeviceBalance<Executor>::launch_sums(DeviceStep<Executor>& step,
                                          const ResidentArrays& resident, Fixed* x,
                                          SumMembers::Stage stage) {
  Executor& executor = step.executor();
  executor.launch_blocks(view_.runs, SumMembers::kThreads, SumMembers::kSharedFloats,
                         SumMembers{step.arrays(), resident, view_, x, stage, kHard});
  executor.launch_blocks(
      view_.count, BeginSearch::kThreads, BeginSearch::kSharedFloats,
      BeginSearch{step.arrays(), resident, view_, stage == SumMembers::kCompared});
}

template <class Executor>
void DeviceBalance<Executor>::launch_search(DeviceStep<Executor>& step,
                                            const BalanceContacts& contacts, bool starts,
                                            int trials) {
  Executor& executor = step.executor();
  if (contacts.resident.slots == 0) return;
  const double tolerance = starts ? kRough : kAccuracy;
  const int all = is_large_ ? kManyTimes * trials : trials;
  for (int trial = 0; trial < all; ++trial) {
    executor.launch_blocks(view_.runs, SumAnswers::kThreads, SumAnswers::kSharedFloats,
                           SumAnswers{contacts});
    executor.launch_blocks(view_.count, LookAtAnswers::kThreads, LookAtAnswers::kSharedFloats,
                           LookAtAnswers{view_, starts, tolerance});
  }
  executor.launch_turns(view_.count, EndSearch::kThreads, EndSearch::kSharedFloats,
                        EndSearch{{contacts}, starts, tolerance});
}

template <class Executor>
void DeviceBalance<Executor>::launch_start(DeviceStep<Executor>& step,
                                           const ResidentArrays& resident) {
  if (view_.count == 0 || resident.slots == 0 || !step.sweeps()) return;
  launch_sums(step, resident, resident.start, SumMembers::kStart);
  launch_search(step, {step.arrays(), resident, view_, resident.start, kSoft}, true, kStartTrials);
  step.executor().launch(step.particles(),
                         MoveMembers{step.arrays(), resident, view_, resident.start});
}

template <class Executor>
void DeviceBalance<Executor>::launch_end(DeviceStep<Executor>& step,
                                         const ResidentArrays& resident) {
  if (view_.count == 0) return;
  Fixed* x = ended_.data();
  const BalanceContacts contacts = {step.arrays(), resident, view_, x, kHard};
  launch_sums(step, resident, x, SumMembers::kEnded);
  launch_search(step, contacts, false, kFirstTrials);
  launch_sums(step, resident, x, SumMembers::kMoved);
  launch_search(step, contacts, false, kSecondTrials);
  launch_sums(step, resident, x, SumMembers::kCompared);
}

}  // namespace pliant
