#pragma once

#include <cstdint>
#include <string>

#include "pliant/core/step/timer.h"

namespace pliant {

/// A bar on stderr, redrawn a few times a second.
class ProgressBar {
 public:
  explicit ProgressBar(bool is_shown) : is_shown_(is_shown) {}
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `step` of `steps` is done, at simulated `time` [s].
  void update(std::uint64_t step, std::uint64_t steps, double time);
  /// `done` of `total` is done; `what` runs now.
  void update(double done, double total, const std::string& what);
  /// Leaves an empty line where the bar was.
  void clear();

 private:
  bool is_due(bool is_last);
  void draw(double share, const std::string& text);

  bool is_shown_;
  bool is_drawn_ = false;
  double next_ = 0.0;  // when to draw again [s]
  Timer timer_;
};

}  // namespace pliant
