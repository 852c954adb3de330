#include "pliant/scene/keyframes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_times(const std::vector<double>& times) {
  if (times.empty()) throw InputError("there is no keyframe");
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!(times[k] >= 0.0 && times[k] <= Keyframes::kMaxTime)) {
      throw InputError(fmt::format("keyframes[{}].time is {}, but must be from 0 to {:g} s", k,
                                   times[k], Keyframes::kMaxTime));
    }
    if (k > 0 && !(times[k] - times[k - 1] >= Keyframes::kMinInterval)) {
      throw InputError(fmt::format(
          "keyframes[{}].time is {} s, but must be at least {:g} s after the one before ({} s)", k,
          times[k], Keyframes::kMinInterval, times[k - 1]));
    }
  }
}

/// Slope of a monotone cubic at an inner keyframe: the weighted harmonic mean of the slopes beside
/// it (Fritsch and Butland 1984), 0 where they differ in sign.
double inner_slope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0.0) return 0.0;
  const double w0 = 2.0 * h1 + h0;
  const double w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

}  // namespace

Keyframes::Keyframes(std::vector<std::string> joints, std::vector<double> times,
                     Eigen::MatrixXd positions, Interpolation interpolation, bool loop)
    : joints_(std::move(joints)),
      times_(std::move(times)),
      positions_(std::move(positions)),
      interpolation_(interpolation),
      loop_(loop) {
  check_times(times_);
  if (positions_.rows() != static_cast<Eigen::Index>(joints_.size()) ||
      positions_.cols() != static_cast<Eigen::Index>(times_.size())) {
    throw InputError(fmt::format("{} x {} positions do not fit {} joints and {} keyframes",
                                 positions_.rows(), positions_.cols(), joints_.size(),
                                 times_.size()));
  }
  if (!(positions_.cwiseAbs().array() <= kMaxPosition).all()) {
    throw InputError(fmt::format("a position is not within {:g} m or rad", kMaxPosition));
  }
  if (loop_ && (times_.size() < 2 || positions_.leftCols(1) != positions_.rightCols(1))) {
    throw InputError(
        "with loop the last keyframe must have the positions of the first, so that "
        "the robot does not jump");
  }
  compute_slopes();
}

void Keyframes::compute_slopes() {
  slopes_.setZero(positions_.rows(), positions_.cols());
  for (std::size_t k = 1; k + 1 < times_.size(); ++k) {
    const double h0 = times_[k] - times_[k - 1];
    const double h1 = times_[k + 1] - times_[k];
    const auto column = static_cast<Eigen::Index>(k);
    for (Eigen::Index j = 0; j < positions_.rows(); ++j) {
      const double d0 = (positions_(j, column) - positions_(j, column - 1)) / h0;
      const double d1 = (positions_(j, column + 1) - positions_(j, column)) / h1;
      slopes_(j, column) = inner_slope(h0, h1, d0, d1);
    }
  }
}

Keyframes::Speed Keyframes::top_speed(int joint) const {
  Speed top;
  for (std::size_t k = 1; k < times_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double h = times_[k] - times_[k - 1];
    const double mean = (positions_(joint, column) - positions_(joint, column - 1)) / h;
    double speed = std::abs(mean);
    if (interpolation_ == Interpolation::kCubic) {
      // The slope of the cubic of position() is m0 + c s + e s² for s in [0, 1].
      const double m0 = slopes_(joint, column - 1), m1 = slopes_(joint, column);
      const double c = 6.0 * mean - 4.0 * m0 - 2.0 * m1;
      const double e = 3.0 * (m0 + m1 - 2.0 * mean);
      const double s = e != 0.0 ? std::clamp(-0.5 * c / e, 0.0, 1.0) : 0.0;
      speed = std::max({std::abs(m0), std::abs(m1), std::abs(m0 + c * s + e * s * s)});
    }
    if (speed > top.value) top = {speed, times_[k - 1], times_[k]};
  }
  return top;
}

double Keyframes::position(int joint, double time) const {
  if (loop_ && time > times_.back()) {
    time = times_.front() + std::fmod(time - times_.front(), times_.back() - times_.front());
  }
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  if (next == times_.begin()) return positions_(joint, 0);
  if (next == times_.end()) return positions_(joint, positions_.cols() - 1);
  const auto k = static_cast<Eigen::Index>(next - times_.begin());
  const double h = *next - *(next - 1);
  const double s = (time - *(next - 1)) / h;
  const double a = positions_(joint, k - 1);
  const double b = positions_(joint, k);
  if (interpolation_ == Interpolation::kLinear) return a + s * (b - a);
  // Cubic Hermite: a + (b - a) s²(3 - 2s) + h s(1 - s)[(1 - s) a' - s b']
  const double bend = (1.0 - s) * slopes_(joint, k - 1) - s * slopes_(joint, k);
  const double value = a + (b - a) * s * s * (3.0 - 2.0 * s) + h * s * (1.0 - s) * bend;
  return std::clamp(value, std::min(a, b), std::max(a, b));  // round-off may leave the interval
}

}  // namespace pliant
