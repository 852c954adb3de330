#pragma once

#include <algorithm>
#include <vector>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/vector3.h"

namespace pliant {

/// So many numbers are summed one after the other, then what comes of that, until one is left.
constexpr int kSumRun = 32;

/// Σ of(i) over [0, count), in an order that the GPU's sums have as well. `sums` is memory that
/// serves the next sum too.
template <class Of>
Double3 sum_by_runs(int count, const Of& of, std::vector<Double3>& sums) {
  constexpr int kRuns = 256;  // that a thread takes at once
  if (count == 0) return {0.0, 0.0, 0.0};
  const auto sum_run = [&](int run, int size, const auto& value) {
    Double3 sum = {0.0, 0.0, 0.0};
    for (int i = run * kSumRun; i < std::min(size, (run + 1) * kSumRun); ++i) sum += value(i);
    return sum;
  };
  int size = (count + kSumRun - 1) / kSumRun;
  sums.resize(static_cast<std::size_t>(size));
  parallel_for(0, size, kRuns, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) sums[static_cast<std::size_t>(r)] = sum_run(r, count, of);
  });
  const auto summed = [&](int i) { return sums[static_cast<std::size_t>(i)]; };
  while (size > 1) {
    const int runs = (size + kSumRun - 1) / kSumRun;
    // The numbers of a run lie behind its own place.
    for (int r = 0; r < runs; ++r) sums[static_cast<std::size_t>(r)] = sum_run(r, size, summed);
    size = runs;
  }
  return sums.front();
}

}  // namespace pliant
