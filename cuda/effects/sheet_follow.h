#pragma once

#include "cuda/core/shared_numbers.h"
#include "pliant/core/parallel/run_sum.h"
#include "pliant/effects/self_contact/sheet_pairs.h"

/// How a sheet moved since it was last looked at: kernels of DeviceSheetSearch.
namespace pliant {

/// What a search counts, in the memory of an executor.
struct SheetTally {
  SharedExtreme path;    ///< that no vertex went further than since the last time [m]
  SharedExtreme motion;  ///< likewise, in this step [m]
  SharedCount pairs;
  int is_far;  ///< whether a vertex left what the candidates are good for
  int is_unseen;
  int passes;  ///< whether a pair does
  int unused;
  Double3 mean_motion;  ///< [m]
};

namespace sheet_kernels {

/// But for the mean motion.
struct ClearTally {
  SheetTally* tally;
  PLIANT_HOST_DEVICE void operator()(int) const {
    *tally = {{0}, {0}, 0, 0, 0, 0, 0, tally->mean_motion};
  }
};

/// Displacement since the last start, and motion of this step.
struct DisplacementSums {
  Double3 displacement, motion;
};

/// The first round of sums as sum_by_runs() makes them.
struct SumDisplacements {
  const Double3 *before, *start, *end;
  int size;
  DisplacementSums* sums;
  PLIANT_HOST_DEVICE void operator()(int run) const {
    DisplacementSums sum = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (int i = run * kSumRun; i < size && i < (run + 1) * kSumRun; ++i) {
      sum.displacement += start[i] - before[i];
      sum.motion += end[i] - start[i];
    }
    sums[run] = sum;
  }
};

struct SumSums {
  const DisplacementSums* from;
  int size;
  DisplacementSums* sums;
  PLIANT_HOST_DEVICE void operator()(int run) const {
    DisplacementSums sum = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (int i = run * kSumRun; i < size && i < (run + 1) * kSumRun; ++i) {
      sum.displacement += from[i].displacement;
      sum.motion += from[i].motion;
    }
    sums[run] = sum;
  }
};

/// Places of a search, of the sheet's vertices.
struct SheetPlaces {
  Double3 *start, *end;                      ///< of this step, ends without the mean motion
  Double3 *collected_start, *collected_end;  ///< when candidates were collected
  double* slacks;
};

/// As SheetTreeSearch::follow() and are_candidates_good().
struct Follow {
  const Double3 *from, *to;
  SheetPlaces places;
  const DisplacementSums* sum;
  double vertices;
  bool is_first;
  SheetTally* tally;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Double3 mean = sum->motion / vertices;
    const Double3 displacement = is_first ? Double3{0.0, 0.0, 0.0} : sum->displacement / vertices;
    tally->path.raise(norm(from[i] - places.start[i] - displacement));
    const Double3 start = from[i], end = to[i] - mean;
    places.start[i] = start;
    places.end[i] = end;
    tally->motion.raise(norm(end - start));
    if (i == 0) tally->mean_motion = mean;
    if (is_first) return;
    places.collected_start[i] += displacement;
    places.collected_end[i] += displacement;
    if (!is_near(end, i) || !is_near(start, i)) tally->is_far = 1;
  }

 private:
  PLIANT_HOST_DEVICE bool is_near(const Double3& x, int i) const {
    return sheet_pairs::is_near_path(x, places.collected_start[i], places.collected_end[i],
                                     places.slacks[i]);
  }
};

/// As SheetTreeSearch::is_seen().
struct LookForUnseen {
  const Double3 *x, *end;
  double most;
  SheetTally* tally;
  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (squared_norm(x[i] - end[i] - tally->mean_motion) > most * most) tally->is_unseen = 1;
  }
};

}  // namespace sheet_kernels
}  // namespace pliant
