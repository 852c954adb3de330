#pragma once

#include <algorithm>
#include <vector>

#include "pliant/core/parallel/parallel.h"

namespace pliant {

/// What `of_part(begin, end)` gives for parts of [begin, end) of `grain` numbers each, joined in
/// order: the cut does not depend on the threads, so neither do sums. Of a range of one part it is
/// what that part gives.
template <class Part, class Join>
auto parallel_reduce(int begin, int end, int grain, const Part& of_part, const Join& join) {
  if (end - begin <= grain) return of_part(begin, end);
  const int parts = (end - begin + grain - 1) / grain;
  std::vector<decltype(of_part(begin, end))> results(static_cast<std::size_t>(parts));
  parallel_for(0, parts, 1, [&](int first, int last) {
    for (int p = first; p < last; ++p) {
      const int from = begin + p * grain;
      results[static_cast<std::size_t>(p)] = of_part(from, std::min(end, from + grain));
    }
  });
  auto result = results.front();
  for (std::size_t p = 1; p < results.size(); ++p) result = join(result, results[p]);
  return result;
}

/// Σ of term(i) over [begin, end).
template <class Term>
double parallel_sum(int begin, int end, int grain, const Term& term) {
  return parallel_reduce(
      begin, end, grain,
      [&](int from, int to) {
        double sum = 0.0;
        for (int i = from; i < to; ++i) sum += term(i);
        return sum;
      },
      [](double a, double b) { return a + b; });
}

}  // namespace pliant
