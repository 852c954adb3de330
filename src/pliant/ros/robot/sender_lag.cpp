#include "pliant/ros/robot/sender_lag.h"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

constexpr double kRest = std::numeric_limits<double>::infinity();
constexpr double kLeastLag = 0.05;  // that is waited for: a message takes its time [s]
constexpr double kRoundOff = 1e-9;  // [s]

}  // namespace

void SenderLag::add(double stamp) {
  const double period = stamp - newest_;
  // Several senders of one robot do not send in order, and one that stands still repeats itself.
  if (period <= 0.0 && period >= -kMostPeriod) return;
  if (period < 0.0) *this = SenderLag();  // the stamp is of another run
  if (newest_ > -kRest && period > 0.0) learn_period(period);
  newest_ = stamp;
}

/// While a sender is raced its messages are as far apart as the simulation was let run ahead: the
/// shortest period counts. It is longer where the simulation had stopped for it.
void SenderLag::learn_period(double period) {
  const bool is_rest = period > kMostPeriod + kRoundOff;
  if (std::exchange(has_stopped_, false)) {
    period_ = is_rest ? kRest : period;
  } else if (!is_rest) {
    period_ = std::min(period_, period);
  }
}

bool SenderLag::is_long(double time, double newest) const {
  if (has_stopped_ || newest_ == -kRest) return false;
  return time - newest > std::max(kLeastLag, 2.0 * period_) + kRoundOff;
}

}  // namespace pliant
