#include "pliant/ros/robot/sender_lag.h"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

constexpr double kRest = std::numeric_limits<double>::infinity();
constexpr double kRoundOff = 1e-9;  // [s]
// How much rarer a trial in vain makes the next one.
constexpr int kRarer = 4, kMostAnswers = 100'000;
// A message that is in time after a late one is close to it, whatever the period.
constexpr int kShortPeriodsOfProof = 2;

}  // namespace

void SenderLag::add(double stamp) {
  const double period = stamp - newest_;
  // Several senders of one robot do not send in order, and one that stands still repeats itself.
  if (period <= 0.0 && period >= -kMostPeriod) return;
  if (period < 0.0) *this = SenderLag();  // the stamp is of another run
  const bool was_waited_for = std::exchange(is_waited_for_, false);
  if (newest_ > -kRest && period > 0.0) learn(period, was_waited_for);
  newest_ = stamp;
}

void SenderLag::learn(double period, bool was_waited_for) {
  const bool is_rest = period > kMostPeriod + kRoundOff;
  if (std::exchange(has_stopped_, false) || allowed_ == kRest) {
    // The simulation did not wait for it, so that the period is its own, or longer.
    allowed_ = is_rest ? kRest : std::max(kLeastLag, period);
    is_proven_ = !is_rest;
    answers_ = 0;
    answers_to_shorten_ = 1;
  } else if (was_waited_for) {
    is_proven_ = true;
    if (++answers_ >= answers_to_shorten_) shorten();
  }
  short_periods_ = period <= allowed_ + kRoundOff ? short_periods_ + 1 : 0;
  is_proven_ = is_proven_ || short_periods_ >= kShortPeriodsOfProof;
}

void SenderLag::shorten() {
  if (allowed_ <= kLeastLag) return;
  allowed_ = std::max(kLeastLag, 0.5 * allowed_);
  is_proven_ = false;
  answers_ = 0;
}

void SenderLag::lengthen() {
  allowed_ = std::min(kMostPeriod, 2.0 * allowed_);
  answers_ = 0;
  answers_to_shorten_ = std::min(kMostAnswers, kRarer * answers_to_shorten_);
}

double SenderLag::begin_waiting() {
  is_waited_for_ = true;
  return is_proven_ ? kPatience : kTrialPatience;
}

void SenderLag::give_up() {
  is_waited_for_ = false;
  if (is_proven_ || allowed_ >= kMostPeriod) {
    has_stopped_ = true;
  } else {
    lengthen();
  }
}

bool SenderLag::is_long(double time, double newest) const {
  if (has_stopped_ || newest_ == -kRest) return false;
  return time - newest > allowed_ + kRoundOff;
}

}  // namespace pliant
