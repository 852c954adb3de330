#pragma once

#include "cuda/solvers/matrix/multigrid_arrays.h"

namespace pliant {

/// Launches a V-cycle from where BeginSweeps, whose sweep is the first one, has left the places:
/// found[1] ends as B wanted, view.sweeps being those of a Smoother. Five launches for the finest
/// level, six for each that is too large for one block, and one for all others.
template <class Executor>
void launch_cycle(Executor& executor, int scenes, const StepArrays& arrays,
                  const MatrixView& matrix, const QuasiNewtonView& view,
                  const MultigridArrays<Executor>& multigrid, bool has_holds) {
  CoarseView coarse = multigrid.view();
  coarse.has_holds = has_holds;
  const auto sweep = [&](int k) {
    executor.launch(arrays.particles, SweepMatrix{arrays, matrix, view, k});
  };
  const auto on_level = [&](int level, CoarseStep::What what) {
    const auto [begin, rows] = multigrid.rows(level);
    executor.launch(rows, CoarseStep{arrays, view, coarse, begin, what});
  };
  const int levels = multigrid.launched_levels();
  sweep(1);
  executor.launch(arrays.particles, FineResidual{arrays, matrix, view});
  for (int level = 0; level < levels; ++level) {
    on_level(level, level == 0 ? CoarseStep::kRestrictFine : CoarseStep::kRestrict);
    on_level(level, CoarseStep::kSecond);
    on_level(level, CoarseStep::kResidual);
  }
  executor.launch_blocks(scenes, CoarseBottom::kThreads, 0, CoarseBottom{arrays, view, coarse});
  for (int level = levels - 1; level >= 0; --level) {
    on_level(level, CoarseStep::kProlong);
    on_level(level, CoarseStep::kFirst);
    on_level(level, CoarseStep::kSecond);
  }
  executor.launch(arrays.particles, FineProlong{arrays, view, coarse});
  sweep(0);
  sweep(1);
}

}  // namespace pliant
