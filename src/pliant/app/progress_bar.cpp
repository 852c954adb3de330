#include "pliant/app/progress_bar.h"

#include <fmt/format.h>

#include <cstdio>

namespace pliant {
namespace {
constexpr double kInterval = 0.1;  // [s]
constexpr int kWidth = 40;
}  // namespace

void ProgressBar::update(std::uint64_t step, double time) {
  const double now = is_shown_ ? timer_.seconds() : 0.0;
  if (!is_shown_ || (now < next_ && step != steps_)) return;
  next_ = now + kInterval;
  const double share = static_cast<double>(step) / static_cast<double>(steps_);
  const int full = static_cast<int>(share * kWidth);
  const double left = step > 0 ? now * (1.0 - share) / share : 0.0;
  fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f} %  step {}  {:.3f} s  {:.0f} s left \x1b[K", "",
             full, "", kWidth - full, 100.0 * share, step, time, left);
  std::fflush(stderr);
  is_drawn_ = true;
}

void ProgressBar::clear() {
  if (!is_drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  is_drawn_ = false;
}

}  // namespace pliant
