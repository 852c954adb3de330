#pragma once

#include "cuda/solvers/device_step.h"

/// Iterations of L-BFGS of DeviceStep. Each ends where its forces are known, so that the last one
/// is as sure as the others; a step that the line search refuses is an iteration too.
namespace pliant {

template <class Executor>
void DeviceStep<Executor>::launch_quasi_newton_begin(int iterations) {
  const QuasiNewtonView& view = quasi_newton_.view();
  executor_.launch(scenes_, BeginControl{arrays_});
  executor_.launch(scenes_, BeginQuasiNewtonState{arrays_, view});
  executor_.launch(arrays_.particles, BeginQuasiNewton{arrays_, view, start_.data()});
  launch_judged(JudgeStep::kFirst, iterations);
  if (contacts_.any) launch_touches(1, iterations);
}

template <class Executor>
void DeviceStep<Executor>::launch_quasi_newton(int count, int iterations) {
  for (int k = 0; k < count; ++k) {
    launch_direction();
    executor_.launch(arrays_.particles, TrialStep{arrays_, quasi_newton_.view()});
    launch_judged(JudgeStep::kTrial, iterations);
    if (contacts_.any) launch_touches(JudgeStep::kMostSweeps, iterations);
  }
}

template <class Executor>
void DeviceStep<Executor>::run_quasi_newton(int iterations) {
  executor_.replay(graph_);
  // They are long launches: those after the last one that is needed cost more than to ask.
  for (int k = kRun; k < iterations; k += kRun) {
    const std::vector<StepControl> now = control();
    const auto is_done = [](const StepControl& of) { return of.done_at >= 0; };
    if (std::all_of(now.begin(), now.end(), is_done)) break;
    executor_.replay(more_);
  }
  executor_.launch(arrays_.particles, StepResult{arrays_, result_.data()});
}

template <class Executor>
void DeviceStep<Executor>::launch_judged(JudgeStep::Where where, int iterations) {
  const AskedState asked = {arrays_, where == JudgeStep::kTrial};
  const QuasiNewtonView& view = quasi_newton_.view();
  launch_fits(executor_, elements_.clusters, asked);
  executor_.launch_blocks(blocks_, threads_, shared_.before_sums() + kForceMeasures * arrays_.block,
                          ForceStep{block_forces(), contacts_, asked, view});
  using Sums = JudgeStep::Sums;
  executor_.launch_blocks(scenes_, Sums::kThreads, Sums::kSharedFloats,
                          JudgeStep{arrays_, view, block_begins_.data(), where, iterations});
}

template <class Executor>
void DeviceStep<Executor>::launch_touches(int count, int iterations) {
  for (int k = 0; k < count; ++k) {
    executor_.launch(arrays_.particles, TouchStep{arrays_, contacts_, quasi_newton_.view()});
    if (embedded_) {
      launch_carried();
      executor_.launch(arrays_.particles, LandTouched{arrays_});
    }
    launch_judged(JudgeStep::kSwept, iterations);
  }
}

template <class Executor>
void DeviceStep<Executor>::launch_direction() {
  const QuasiNewtonView& view = quasi_newton_.view();
  const MatrixView& matrix = matrix_.view();
  const int* begins = block_begins_.data();
  const int block = arrays_.block, pairs = PairProducts::count(view.slots());
  constexpr int kThreads = WideSceneSum::kThreads;
  if (contacts_.any) executor_.launch(arrays_.particles, HoldStep{arrays_, contacts_, view});
  executor_.launch_blocks(blocks_, block, pairs * block, PairProducts{arrays_, contacts_, view});
  executor_.launch_blocks(scenes_, kThreads, WideSceneSum::shared_floats(pairs),
                          FirstLoop{arrays_, view, begins});
  executor_.launch(arrays_.particles, BeginSweeps{arrays_, contacts_, view});
  if (multigrid_.is_there()) {
    launch_cycle(executor_, scenes_, arrays_, matrix, view, multigrid_, contacts_.any);
  } else {
    for (int k = 1; k < view.sweeps; ++k) {
      executor_.launch(arrays_.particles, SweepMatrix{arrays_, matrix, view, k});
    }
  }
  executor_.launch_blocks(blocks_, block, view.slots() * block, FoundProducts{arrays_, view});
  executor_.launch_blocks(scenes_, kThreads, WideSceneSum::shared_floats(view.slots()),
                          SecondLoop{arrays_, view, begins});
}

}  // namespace pliant
