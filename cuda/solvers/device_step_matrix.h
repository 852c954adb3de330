#pragma once

#include "cuda/solvers/device_step.h"
#include "cuda/solvers/sweep_step.h"
#include "cuda/solvers/weighted_step.h"

/// Iterations of DeviceStep that read the matrix of projective dynamics.
namespace pliant {

template <class Executor>
void DeviceStep<Executor>::launch_gradient_step(const Acceleration& iteration) {
  executor_.launch_blocks(blocks_, threads_,
                          shared_.before_sums() + PullStep::kNumbers * arrays_.block,
                          PullStep{block_forces(), contacts_, iteration, matrix_.view()});
}

template <class Executor>
void DeviceStep<Executor>::launch_weighted(const Acceleration& iteration) {
  const MatrixView& matrix = matrix_.view();
  const int* begins = block_begins_.data();
  launch_gradient_step(iteration);
  executor_.launch_blocks(scenes_, MeanCorrection::Sums::kThreads,
                          MeanCorrection::Sums::kSharedFloats,
                          MeanCorrection{arrays_, matrix.lengths, begins});
  executor_.launch_blocks(blocks_, arrays_.block, 2 * arrays_.block,
                          WeightedProducts{arrays_, matrix});
  executor_.launch_blocks(scenes_, BestStep::Sums::kThreads, BestStep::Sums::kSharedFloats,
                          BestStep{arrays_, matrix.products, begins});
  executor_.launch(arrays_.particles, LandWeighted{iteration, matrix});
}

template <class Executor>
void DeviceStep<Executor>::launch_sweep(const Acceleration& iteration) {
  launch_gradient_step(iteration);
  matrix_.for_each_level([&](int first, int rows) {
    executor_.launch(rows, SweepLevel{arrays_, matrix_.view(), first});
  });
  executor_.launch(arrays_.particles, LandSweep{iteration, contacts_, matrix_.view()});
  if (!embedded_) return;
  launch_carried();
  executor_.launch(arrays_.particles, LandCarried{iteration});
}

}  // namespace pliant
