#include "pliant/ros/markers/color_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {
namespace {

const std::array<Eigen::Vector3f, 3> kStops = {Eigen::Vector3f(0.04f, 0.16f, 0.52f),
                                               Eigen::Vector3f(0.53f, 0.53f, 0.52f),
                                               Eigen::Vector3f(1.00f, 0.88f, 0.16f)};

// Of a range that leaves peaks out: the least share of the whole one, and how fast it follows, in
// simulated time [s].
constexpr double kAlike = 1e-3;
constexpr double kWidening = 0.3, kNarrowing = 3.0;

/// 1, 2 or 5 times a power of ten, at least `x` > 0.
double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= x) return digit * power;
  }
  return 10.0 * power;
}

Eigen::Vector3f color_at(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const auto rest = static_cast<float>(place - static_cast<double>(below));
  return (1.0f - rest) * kStops[below] + rest * kStops[below + 1];
}

}  // namespace

ColorScale::ColorScale(double min, double max, double tail)
    : follows_(min == max), tail_(tail), min_(min), max_(max) {}

/// Brings what is shown nearer to what there is.
void ColorScale::near(double least, double most, double time) {
  // A scene that was reset begins anew.
  const double passed = tail_ > 0.0 ? time - time_ : 0.0;
  time_ = time;
  if (is_empty_ || passed < 0.0) {
    least_ = least;
    most_ = most;
    is_empty_ = false;
    return;
  }
  const auto share = [&](bool widens) {
    if (tail_ == 0.0) return widens ? 1.0 : 0.0;
    return 1.0 - std::exp(-passed / (widens ? kWidening : kNarrowing));
  };
  least_ += share(least < least_) * (least - least_);
  most_ += share(most > most_) * (most - most_);
}

/// In steps of a fifth, and only where it is too small or more than twice too large, so that it
/// changes seldom. What is alike all over has no range yet.
bool ColorScale::round() {
  const double span = most_ - least_;
  if (!(span > 1e-12 * std::max(std::abs(least_), std::abs(most_)))) return false;
  const bool is_covered = min_ <= least_ && most_ <= max_ && min_ < max_;
  if (is_covered && span > 0.4 * (max_ - min_)) return false;
  const double step = 0.2 * round_up(span);
  const double min = step * std::floor(least_ / step), max = step * std::ceil(most_ / step);
  if (!std::isfinite(min) || !std::isfinite(max) || (min == min_ && max == max_)) return false;
  min_ = min;
  max_ = max;
  return true;
}

bool ColorScale::follow(std::vector<double> values, double time) {
  if (!follows_) return false;
  const auto is_not_finite = [](double value) { return !std::isfinite(value); };
  values.erase(std::remove_if(values.begin(), values.end(), is_not_finite), values.end());
  if (values.empty()) return false;
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  double least = *lowest, most = *highest;
  const double span = most - least;
  const auto last = static_cast<double>(values.size() - 1);
  const auto beyond = static_cast<std::ptrdiff_t>(tail_ * last);
  const auto lower = values.begin() + beyond, upper = values.end() - 1 - beyond;
  std::nth_element(values.begin(), lower, values.end());
  const double inner_least = *lower;
  std::nth_element(values.begin(), upper, values.end());
  // Where nearly all is alike, what differs is what there is to see.
  if (*upper - inner_least > kAlike * span) {
    least = inner_least;
    most = *upper;
  }
  near(least, most, time);
  return round();
}

Eigen::Matrix3Xf ColorScale::colors(const Eigen::VectorXd& values) const {
  Eigen::Matrix3Xf colors(3, values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double share = min_ < max_ ? (values[i] - min_) / (max_ - min_) : 0.0;
    colors.col(i) = std::isfinite(values[i]) ? color_at(share) : Eigen::Vector3f::Ones();
  }
  return colors;
}

}  // namespace pliant
