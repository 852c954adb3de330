#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

namespace pliant {

/// Whether tests run for what their kernels touch and not for where the bodies go: under tools
/// that make a kernel a thousand times slower (scripts/sanitize sets PLIANT_BRIEF). Says so.
inline bool is_brief() {
  static const bool brief = [] {
    const char* set = std::getenv("PLIANT_BRIEF");
    const bool is_set = set != nullptr && set[0] != '\0';
    if (is_set)
      std::fputs("PLIANT_BRIEF is set: what many repetitions lead to is not judged\n", stderr);
    return is_set;
  }();
  return brief;
}

/// How often something is repeated. What is seldom repeated launches the same kernels.
inline int times(int usually, int briefly) { return is_brief() ? briefly : usually; }

}  // namespace pliant

/// Before what holds only after all the repetitions: the test ends here if it is brief.
#define PLIANT_END_IF_BRIEF()         \
  do {                                \
    if (::pliant::is_brief()) return; \
  } while (false)
