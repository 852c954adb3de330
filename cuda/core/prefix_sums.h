#pragma once

#include "pliant/math/host_device.h"

/// Sums of whole numbers before each of them, in the memory of an executor.
namespace pliant {

struct ClearCounts {
  int* counts;
  PLIANT_HOST_DEVICE void operator()(int i) const { counts[i] = 0; }
};

namespace prefix_kernels {

/// Each of `sums` becomes what those before it add up to, after `before`.
PLIANT_HOST_DEVICE inline void sum_before_each(int* sums, int count, int before) {
  for (int k = 0; k < count; ++k) {
    const int sum = sums[k];
    sums[k] = before;
    before += sum;
  }
}

/// Sums before each number, in two rounds: of blocks of kRun numbers, then within them.
struct SumRuns {
  static constexpr int kPhases = 2;
  static constexpr int kThreads = 128;
  static constexpr int kEach = 8;
  static constexpr int kRun = kThreads * kEach;
  const int* counts;
  int* sums;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    auto* own = reinterpret_cast<int*>(shared);
    if (phase == 0) {
      int sum = 0;
      for (int k = 0; k < kEach; ++k) sum += counts[block * kRun + k * kThreads + thread];
      own[thread] = sum;
    } else if (thread == 0) {
      int sum = 0;
      for (int t = 0; t < kThreads; ++t) sum += own[t];
      sums[block] = sum;
    }
  }
};

/// One block: of all runs.
struct ScanSums {
  static constexpr int kPhases = 3;
  static constexpr int kThreads = 256;
  int runs;
  int* sums;  ///< becomes the sum before each

  PLIANT_HOST_DEVICE void operator()(int phase, int, int thread, float* shared) const {
    auto* own = reinterpret_cast<int*>(shared);
    const int each = (runs + kThreads - 1) / kThreads;
    const int begin = thread * each, end = begin + each < runs ? begin + each : runs;
    if (phase == 0) {
      int sum = 0;
      for (int k = begin; k < end; ++k) sum += sums[k];
      own[thread] = sum;
    } else if (phase == 1 && thread == 0) {
      sum_before_each(own, kThreads, 0);
    } else if (phase == 2) {
      int before = own[thread];
      for (int k = begin; k < end; ++k) {
        const int sum = sums[k];
        sums[k] = before;
        before += sum;
      }
    }
  }
};

struct PlaceRuns {
  static constexpr int kPhases = 3;
  static constexpr int kThreads = SumRuns::kThreads, kEach = SumRuns::kEach;
  int* counts;  ///< become the sums before them
  const int* sums;
  int* begins;  ///< likewise, and the end
  int size, all;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    auto* own = reinterpret_cast<int*>(shared);
    const int first = block * SumRuns::kRun + thread * kEach;
    if (phase == 0) {
      int sum = 0;
      for (int k = 0; k < kEach; ++k) sum += counts[first + k];
      own[thread] = sum;
    } else if (phase == 1 && thread == 0) {
      sum_before_each(own, kThreads, sums[block]);
    } else if (phase == 2) {
      int before = own[thread];
      for (int k = 0; k < kEach; ++k) {
        const int count = counts[first + k];
        begins[first + k] = counts[first + k] = before;
        before += count;
      }
      if (first + kEach == size && all >= 0) begins[size] = all;
    }
  }
};

}  // namespace prefix_kernels

/// Numbers are summed in runs of so many.
constexpr int kPrefixRun = prefix_kernels::SumRuns::kRun;
inline int whole_prefix_runs(int size) { return (size + kPrefixRun - 1) / kPrefixRun * kPrefixRun; }

/// `counts`, and `begins` likewise, become what those before each add up to; `size` of them, whole
/// runs. `sums` is memory for one number a run. Where the sum of `all` is known, `begins` has one
/// more, which becomes that; else it is negative.
template <class Executor>
void sum_before(Executor& executor, int* counts, int size, int* sums, int* begins, int all) {
  using namespace prefix_kernels;
  const int runs = size / kPrefixRun;
  executor.launch_blocks(runs, SumRuns::kThreads, SumRuns::kThreads, SumRuns{counts, sums});
  executor.launch_blocks(1, ScanSums::kThreads, ScanSums::kThreads, ScanSums{runs, sums});
  executor.launch_blocks(runs, PlaceRuns::kThreads, PlaceRuns::kThreads,
                         PlaceRuns{counts, sums, begins, size, all});
}

}  // namespace pliant
