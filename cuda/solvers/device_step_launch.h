#pragma once

#include "cuda/solvers/device_step.h"

/// How DeviceStep launches a step's iterations: all in one, or one after the other in a graph.
namespace pliant {

template <class Executor>
void DeviceStep<Executor>::launch_begin() {
  Fixed* mailboxes = mailboxes_.size() > 0 ? mailboxes_.data() : nullptr;
  executor_.launch(arrays_.particles, BeginStep{arrays_, start_.data(), scenes_, mailboxes,
                                                static_cast<int>(mailboxes_.size())});
}

template <class Executor>
void DeviceStep<Executor>::launch_iteration(int number, int place, bool measured) {
  const Acceleration accelerate = {arrays_, {number % 2, place, measured}};
  const int sums = measured ? kMeasures * arrays_.block : 0;
  launch_fits(executor_, elements_.clusters, accelerate);
  if (matrix_.kind() == DeviceIteration::kLineSearch) return launch_weighted(accelerate);
  if (matrix_.kind() == DeviceIteration::kSweep) return launch_sweep(accelerate);
  executor_.launch_blocks(blocks_, threads_, shared_.before_sums() + sums,
                          Iterate{block_forces(), {contacts_, accelerate}});
  if (!embedded_) return;
  launch_carried();
  executor_.launch_blocks(blocks_, arrays_.block, sums, AccelerateCarried{accelerate, contacts_});
}

template <class Executor>
void DeviceStep<Executor>::launch_interval(int first, int count) {
  for (int k = 0; k < count; ++k) launch_iteration(first + k, k, k + 1 == count);
}

template <class Executor>
bool DeviceStep<Executor>::launch_persistent(const IterationPlan& plan) {
  if (shared_places_.end == 0 || embedded_) return false;
  PersistentIteration all = {{block_forces(), shared_places_, {contacts_, {arrays_, {}}}, plan},
                             block_begins_.data(),
                             blocks_,
                             mailboxes_.data()};
  // As many threads share a block's work as leave room for all blocks; few of them take longer than
  // launches do where there are simplices.
  const bool has_simplices = elements_.slot_begins != nullptr;
  const int most = has_simplices ? PersistentIteration::kMostThreads : all.collectors();
  const int least = has_simplices ? kLeastPersistentThreads : arrays_.block;
  int& threads = all.forces.threads;
  threads = std::min(most, PersistentIteration::kMostThreads) / arrays_.block * arrays_.block;
  for (; threads >= least; threads -= arrays_.block) {
    if (!executor_.fits_persistent(blocks_, threads, shared_places_.end, all)) continue;
    executor_.launch_persistent(all.iterations(), blocks_, threads, shared_places_.end, all);
    return true;
  }
  return false;
}

template <class Executor>
void DeviceStep<Executor>::launch_carried() {
  constexpr int kThreads = 512;
  if (!spread_) {
    executor_.launch_blocks(scenes_, kThreads, 0, CarriedContacts{arrays_, contacts_, kThreads});
    return;
  }
  constexpr int kBlocks = 128, kSize = 128;
  const CarriedContacts all = {arrays_, contacts_, kBlocks * kSize};
  for (int phase = 0; phase < CarriedContacts::kPhases; ++phase) {
    executor_.launch_blocks(kBlocks, kSize, 0, SpreadContacts{all, phase, kSize});
  }
}

template <class Executor>
void DeviceStep<Executor>::launch_control(const StepDecision& decide) {
  executor_.launch_blocks(scenes_, ControlStep::kThreads, ControlStep::kSharedFloats,
                          ControlStep{arrays_, block_begins_.data(), decide});
}

template <class Executor>
void DeviceStep<Executor>::launch_iterations(int iterations) {
  if (is_quasi_newton()) {
    launch_quasi_newton_begin(iterations);
    return launch_quasi_newton(iterations, iterations);
  }
  launch_begin();
  const IterationPlan plan = {iterations, delay_};
  if (launch_persistent(plan)) return;
  for (int done = 0; done < iterations;) {
    const int count = plan.length(done);
    launch_interval(done, count);
    done += count;
    launch_control({done, plan.length(done), plan.is_last(done)});
  }
}

template <class Executor>
void DeviceStep<Executor>::capture(int iterations) {
  graph_ = executor_.capture([this, iterations] {
    if (is_quasi_newton()) {
      launch_quasi_newton_begin(iterations);
      launch_quasi_newton(std::min(iterations, kRun), iterations);
    } else {
      launch_iterations(iterations);
      executor_.launch(arrays_.particles, StepResult{arrays_, result_.data()});
    }
  });
  if (!is_quasi_newton() || iterations <= kRun) return;
  more_ = executor_.capture([this, iterations] { launch_quasi_newton(kRun, iterations); });
}

}  // namespace pliant
