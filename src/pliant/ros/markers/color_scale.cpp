#include "pliant/ros/markers/color_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {
namespace {

const std::array<Eigen::Vector3f, 3> kStops = {Eigen::Vector3f(0.04f, 0.16f, 0.52f),
                                               Eigen::Vector3f(0.53f, 0.53f, 0.52f),
                                               Eigen::Vector3f(1.00f, 0.88f, 0.16f)};

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

ColorScale::ColorScale(double min, double max) : follows_(min == max), min_(min), max_(max) {}

bool ColorScale::include(const Eigen::VectorXd& values) {
  if (!follows_) return false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    least_ = is_empty_ ? value : std::min(least_, value);
    most_ = is_empty_ ? value : std::max(most_, value);
    is_empty_ = false;
  }
  if (is_empty_ || (min_ <= least_ && most_ <= max_ && min_ < max_)) return false;
  // In steps of a fifth, so that it changes seldom. What is alike all over has no range yet.
  const double span = most_ - least_;
  if (!(span > 1e-12 * std::max(std::abs(least_), std::abs(most_)))) return false;
  const double step = 0.2 * round_up(span);
  const double min = step * std::floor(least_ / step), max = step * std::ceil(most_ / step);
  if (!std::isfinite(min) || !std::isfinite(max)) return false;
  min_ = min;
  max_ = max;
  return true;
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
