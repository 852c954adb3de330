#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

namespace pliant {

/// Threads that parallel loops may use, the calling one included; 1 at start-up.
int threads();
/// `count` >= 1; throws InputError otherwise. Results do not depend on it.
void set_threads(int count);
/// What most scenes gain from where nobody names a number: two, on a machine that has them.
int usual_threads();

/// Calls body(begin, end) over disjoint parts of [begin, end). The body must not depend on how the
/// range is cut, so that results are bit-identical for any number of threads.
template <class Body>
void parallel_for(int begin, int end, int grain, const Body& body) {
  if (threads() == 1 || end - begin <= grain) {
    if (begin < end) body(begin, end);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<int>(begin, end, static_cast<std::size_t>(grain)),
      [&](const tbb::blocked_range<int>& part) { body(part.begin(), part.end()); },
      tbb::static_partitioner());
}

}  // namespace pliant
