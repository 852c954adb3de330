#include "pliant/app/progress_bar.h"

#include <fmt/format.h>

#include <cstdio>

namespace pliant {
namespace {
constexpr double kInterval = 0.1;  // [s]
constexpr int kWidth = 40;
}  // namespace

bool ProgressBar::is_due(bool is_last) {
  if (!is_shown_) return false;
  const double now = timer_.seconds();
  if (now < next_ && !is_last) return false;
  next_ = now + kInterval;
  return true;
}

void ProgressBar::update(std::uint64_t step, std::uint64_t steps, double time) {
  if (!is_due(step == steps)) return;
  draw(static_cast<double>(step) / static_cast<double>(steps),
       fmt::format("step {}  {:.3f} s", step, time));
}

void ProgressBar::update(double done, double total, const std::string& what) {
  if (is_due(done == total)) draw(total > 0.0 ? done / total : 1.0, what);
}

void ProgressBar::draw(double share, const std::string& text) {
  const int full = static_cast<int>(share * kWidth);
  const double left = share > 0.0 ? timer_.seconds() * (1.0 - share) / share : 0.0;
  fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:3.0f} %  {}  {:.0f} s left \x1b[K", "", full, "",
             kWidth - full, 100.0 * share, text, left);
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
