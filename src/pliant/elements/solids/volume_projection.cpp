#include "pliant/elements/solids/volume_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

constexpr int kMaxSteps = 100;  // bisection alone needs no more; Newton's method about five
// Newton's error is squared in its last step: log of the volume's ratio.
constexpr double kLastStep = 1e-9;
constexpr double kLeast = 1e-12;  // share below which a denominator of the slope counts as zero

/// Root of a function that is negative at `lo` >= 0 and positive at `hi`, by Newton's method within
/// the bracket. `evaluate(at)` gives value and derivative.
template <class Evaluate>
double bracketed_root(double lo, double hi, double start, const Evaluate& evaluate) {
  double at = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto [value, slope] = evaluate(at);
    (value < 0.0 ? lo : hi) = at;
    const double next = at - value / slope;
    // NaN fails the comparison too.
    const bool inside = next >= lo && next <= hi;
    if (inside && std::abs(value) < kLastStep) return next;
    // Roots lie at any scale.
    const double middle = lo > 0.0 ? std::sqrt(lo) * std::sqrt(hi) : 0x1p-20 * hi;
    if (!inside && (middle <= lo || middle >= hi)) return at;
    at = inside ? next : middle;
  }
  return at;
}

struct ValueAndSlope {
  double value, slope;
};

/// The positive roots of p² - σ p - μ = 0 for μ > 0, without cancellation for σ < 0.
Eigen::Vector3d grown(const Eigen::Vector3d& sigma, double mu) {
  Eigen::Vector3d p;
  for (int k = 0; k < 3; ++k) {
    const double root = std::sqrt(sigma[k] * sigma[k] + 4.0 * mu);
    p[k] = sigma[k] > 0.0 ? 0.5 * (sigma[k] + root) : 2.0 * mu / (root - sigma[k]);
  }
  return p;
}

VolumeProjection grow(const Eigen::Vector3d& sigma, double volume) {
  // At this μ the smallest p, and with it each, is at least the cube root of the volume.
  const double side = std::cbrt(volume);
  const double most = side * (side - sigma[2]);
  const auto evaluate = [&](double mu) -> ValueAndSlope {
    const Eigen::Vector3d p = grown(sigma, mu);
    // d log p / dμ = 1 / (p (p + μ/p))
    return {std::log(p.prod() / volume), (p.array().square() + mu).inverse().sum()};
  };
  // From 0 the steps rise to the root, since the logarithm is concave in μ.
  const double start = sigma[2] > 0.0 ? 0.0 : 0.5 * most;
  const double mu = bracketed_root(0.0, most, start, evaluate);
  return {grown(sigma, mu), mu};
}

/// Points whose volume is smaller, with μ = -δ p₂ and p₂ = σ₂ - δ: p₂ is the larger root for
/// δ < σ₂/2 and the smaller one beyond. p₀ and p₁ are the larger ones.
class Shrinking {
 public:
  Shrinking(const Eigen::Vector3d& sigma, double volume) : sigma_(sigma), volume_(volume) {}

  double half() const { return 0.5 * sigma_[2]; }

  /// The solution with δ up to σ₂/2; without one, a point at an infinite distance.
  VolumeProjection shrink() const {
    if (value(half(), half()).value > 0.0) return {sigma_, kNowhere};
    const auto evaluate = [&](double delta) {
      const auto [value, slope] = this->value(delta, sigma_[2] - delta);
      return ValueAndSlope{-value, slope};
    };
    const double delta = bracketed_root(0.0, half(), 0.0, evaluate);
    return at(delta, sigma_[2] - delta);
  }

  /// The nearest solution with p₂ below σ₂/2, if it is nearer than `best`.
  void flatten(VolumeProjection& best) const {
    constexpr int kSamples = 64;  // the volume has one hump in between, much wider than a sample
    const double least = 0.5 * volume_ / (sigma_[0] * sigma_[1]);
    if (!(least < half())) return;
    const double factor = std::pow(half() / least, 1.0 / kSamples);
    const auto evaluate = [&](double p2) { return value(sigma_[2] - p2, p2); };
    double lo = least;
    for (int k = 1; k <= kSamples; ++k) {
      const double hi = k < kSamples ? least * std::pow(factor, k) : half();
      if (evaluate(lo).value < 0.0 && evaluate(hi).value >= 0.0) {
        const double p2 = bracketed_root(lo, hi, 0.5 * (lo + hi), evaluate);
        const VolumeProjection candidate = at(sigma_[2] - p2, p2);
        if (candidate.squared_distance() < best.squared_distance()) best = candidate;
      }
      lo = hi;
    }
  }

 private:
  static constexpr double kNowhere = -std::numeric_limits<double>::infinity();  // μ

  // δ and p₂ both, so that neither loses digits where it is small.
  VolumeProjection at(double delta, double p2) const {
    return {{0.5 * (sigma_[0] + root(0, delta)), 0.5 * (sigma_[1] + root(1, delta)), p2},
            -delta * p2};
  }
  /// log(p₀ p₁ p₂ / volume) and its slope over p₂.
  ValueAndSlope value(double delta, double p2) const {
    const Eigen::Vector3d p = at(delta, p2).p;
    const double rest = sigma_[2] - 2.0 * delta;
    return {std::log(p.prod() / volume_),
            1.0 / p2 + rest / (p[0] * root(0, delta)) + rest / (p[1] * root(1, delta))};
  }
  /// √(σ² + 4 μ)
  double root(int k, double delta) const {
    const double rest = sigma_[2] - 2.0 * delta;
    return std::sqrt((sigma_[k] - sigma_[2]) * (sigma_[k] + sigma_[2]) + rest * rest);
  }

  Eigen::Vector3d sigma_;
  double volume_;
};

VolumeProjection shrink(const Eigen::Vector3d& sigma, double volume) {
  const Shrinking shrinking(sigma, volume);
  VolumeProjection best = shrinking.shrink();
  // Flattening moves σ₂ alone by more than half.
  const double half = shrinking.half();
  if (best.squared_distance() > half * half) shrinking.flatten(best);
  return best;
}

}  // namespace

VolumeProjection project_to_volume(const Eigen::Vector3d& sigma, double volume) {
  const double present = sigma.prod();
  if (!sigma.allFinite() || present == volume) return {sigma, 0.0};
  return present < volume ? grow(sigma, volume) : shrink(sigma, volume);
}

StretchSlope volume_slope(const Eigen::Vector3d& sigma, const VolumeProjection& projection) {
  // dσᵢ = (1 + μ/pᵢ²) dpᵢ - dμ/pᵢ and Σ dpᵢ/pᵢ = 0, solved with cᵢ = pᵢ² + μ.
  const Eigen::Vector3d& p = projection.p;
  const Eigen::Vector3d c = p.array().square() + projection.mu;
  const double sum = c[1] * c[2] + c[0] * c[2] + c[0] * c[1];
  const double e = std::max(sum, kLeast * std::pow(p.prod(), 4.0 / 3.0));
  StretchSlope slope;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    slope.stretch(k, k) = p[k] * p[k] * (c[i] + c[j]) / e;
    slope.stretch(i, j) = slope.stretch(j, i) = -p[i] * p[j] * c[k] / e;
    // (pᵢ - pⱼ) (1 + μ/(pᵢ pⱼ)) = σᵢ - σⱼ
    const double product = p[i] * p[j];
    slope.flip[k] = product / std::max(product + projection.mu, kLeast * product);
  }
  slope.twist = twist_slopes(sigma, p);
  return slope;
}

}  // namespace pliant
