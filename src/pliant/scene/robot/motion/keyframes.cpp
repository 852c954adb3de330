#include "pliant/scene/robot/motion/keyframes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_times(const KeyframeSamples& samples) {
  const std::vector<double>& times = samples.times;
  if (times.empty()) throw InputError("there is no keyframe");
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!(times[k] >= 0.0 && times[k] <= Keyframes::kMaxTime)) {
      throw InputError(fmt::format("keyframes[{}].time is {}, but must be from 0 to {:g} s",
                                   samples.keyframes[k], times[k], Keyframes::kMaxTime));
    }
    if (k > 0 && !(times[k] - times[k - 1] >= Keyframes::kMinInterval)) {
      throw InputError(fmt::format(
          "keyframes[{}].time is {} s, but must be at least {:g} s after the one before ({} s)",
          samples.keyframes[k], times[k], Keyframes::kMinInterval, times[k - 1]));
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

KeyframeSamples keyframes_alone(std::vector<double> times, Eigen::MatrixXd positions) {
  std::vector<int> numbers(times.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::vector<bool> rests(times.size(), false);
  return {std::move(times), std::move(positions), std::move(numbers), std::move(rests)};
}

}  // namespace

Keyframes::Keyframes(std::vector<std::string> joints, std::vector<double> times,
                     Eigen::MatrixXd positions, Interpolation interpolation, bool loop)
    : Keyframes(std::move(joints), keyframes_alone(std::move(times), std::move(positions)),
                interpolation, loop) {}

Keyframes::Keyframes(std::vector<std::string> joints, KeyframeSamples samples,
                     Interpolation interpolation, bool loop)
    : joints_(std::move(joints)),
      samples_(std::move(samples)),
      interpolation_(interpolation),
      loop_(loop) {
  check_times(samples_);
  const std::size_t times = samples_.times.size();
  const Eigen::MatrixXd& positions = samples_.positions;
  if (positions.rows() != static_cast<Eigen::Index>(joints_.size()) ||
      positions.cols() != static_cast<Eigen::Index>(times)) {
    throw InputError(fmt::format("{} x {} positions do not fit {} joints and {} keyframes",
                                 positions.rows(), positions.cols(), joints_.size(), times));
  }
  if (!(positions.cwiseAbs().array() <= kMaxPosition).all()) {
    throw InputError(fmt::format("a position is not within {:g} m or rad", kMaxPosition));
  }
  if (loop_ && (times < 2 || positions.leftCols(1) != positions.rightCols(1))) {
    throw InputError(
        "with loop the last keyframe must have the positions of the first, so that "
        "the robot does not jump");
  }
  compute_slopes();
}

void Keyframes::compute_slopes() {
  const auto& [times, positions, keyframes, rests] = samples_;
  slopes_.setZero(positions.rows(), positions.cols());
  for (std::size_t k = 1; k + 1 < times.size(); ++k) {
    if (rests[k]) continue;
    const double h0 = times[k] - times[k - 1];
    const double h1 = times[k + 1] - times[k];
    const auto column = static_cast<Eigen::Index>(k);
    for (Eigen::Index j = 0; j < positions.rows(); ++j) {
      const double d0 = (positions(j, column) - positions(j, column - 1)) / h0;
      const double d1 = (positions(j, column + 1) - positions(j, column)) / h1;
      slopes_(j, column) = inner_slope(h0, h1, d0, d1);
    }
  }
}

Keyframes::Speed Keyframes::top_speed(int joint) const {
  const std::vector<double>& times = samples_.times;
  const Eigen::MatrixXd& positions = samples_.positions;
  Speed top;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double h = times[k] - times[k - 1];
    const double mean = (positions(joint, column) - positions(joint, column - 1)) / h;
    double speed = std::abs(mean);
    if (interpolation_ == Interpolation::kCubic) {
      // The slope of the cubic of position() is m0 + c s + e s² for s in [0, 1].
      const double m0 = slopes_(joint, column - 1), m1 = slopes_(joint, column);
      const double c = 6.0 * mean - 4.0 * m0 - 2.0 * m1;
      const double e = 3.0 * (m0 + m1 - 2.0 * mean);
      const double s = e != 0.0 ? std::clamp(-0.5 * c / e, 0.0, 1.0) : 0.0;
      speed = std::max({std::abs(m0), std::abs(m1), std::abs(m0 + c * s + e * s * s)});
    }
    if (speed > top.value) top = {speed, times[k - 1], times[k]};
  }
  return top;
}

double Keyframes::position(int joint, double time) const {
  const std::vector<double>& times = samples_.times;
  const Eigen::MatrixXd& positions = samples_.positions;
  if (loop_ && time > times.back()) {
    time = times.front() + std::fmod(time - times.front(), times.back() - times.front());
  }
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return positions(joint, 0);
  if (next == times.end()) return positions(joint, positions.cols() - 1);
  const auto k = static_cast<Eigen::Index>(next - times.begin());
  const double h = *next - *(next - 1);
  const double s = (time - *(next - 1)) / h;
  const double a = positions(joint, k - 1);
  const double b = positions(joint, k);
  if (interpolation_ == Interpolation::kLinear) return a + s * (b - a);
  // Cubic Hermite: a + (b - a) s²(3 - 2s) + h s(1 - s)[(1 - s) a' - s b']
  const double bend = (1.0 - s) * slopes_(joint, k - 1) - s * slopes_(joint, k);
  const double value = a + (b - a) * s * s * (3.0 - 2.0 * s) + h * s * (1.0 - s) * bend;
  return std::clamp(value, std::min(a, b), std::max(a, b));  // round-off may leave the interval
}

}  // namespace pliant
