#pragma once

#include <algorithm>

namespace pliant {

/// Threads that parallel loops may use, the calling one included; 1 at start-up.
int threads();
/// `count` >= 1; throws InputError otherwise. Results do not depend on it. Not while a loop runs.
void set_threads(int count);
/// Whether a loop that begins now could have more than one thread: not within another loop.
bool has_free_threads();
/// What most scenes gain from where nobody names a number: two, on a machine that has them.
int usual_threads();

namespace parallel_detail {
/// As ThreadTeam::run(), of the threads that loops use.
bool run_parts(int parts, void (*call)(const void* context, int part), const void* context);
/// In how many parts a range is cut.
int count_parts(int size, int grain);
}  // namespace parallel_detail

/// Calls body(begin, end) over disjoint parts of [begin, end), of about `grain` numbers at the
/// least. The body must not depend on how the range is cut, so that results are bit-identical for
/// any number of threads. Within another loop, and while another thread has one, it calls it once.
template <class Body>
void parallel_for(int begin, int end, int grain, const Body& body) {
  struct Cut {
    int begin, size, parts;
    const Body& body;
  };
  if (begin >= end) return;
  if (threads() > 1 && end - begin > grain) {
    const int parts = parallel_detail::count_parts(end - begin, grain);
    const Cut cut = {begin, end - begin, parts, body};
    const auto call = [](const void* context, int k) {
      const auto& c = *static_cast<const Cut*>(context);
      const auto at = [&](int part) {
        return c.begin + static_cast<int>(static_cast<long long>(c.size) * part / c.parts);
      };
      c.body(at(k), at(k + 1));
    };
    if (parallel_detail::run_parts(parts, call, &cut)) return;
  }
  body(begin, end);
}

}  // namespace pliant
