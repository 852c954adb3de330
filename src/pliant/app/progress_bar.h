#pragma once

#include <cstdint>

#include "pliant/core/timer.h"

namespace pliant {

/// A bar on stderr, redrawn a few times a second.
class ProgressBar {
 public:
  ProgressBar(std::uint64_t steps, bool is_shown) : steps_(steps), is_shown_(is_shown) {}
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::uint64_t step, double time);
  /// Leaves an empty line where the bar was.
  void clear();

 private:
  std::uint64_t steps_;
  bool is_shown_;
  bool is_drawn_ = false;
  double next_ = 0.0;  // when to draw again [s]
  Timer timer_;
};

}  // namespace pliant
