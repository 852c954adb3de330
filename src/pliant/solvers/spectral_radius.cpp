#include "pliant/solvers/spectral_radius.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {
constexpr double kDamping = 0.75;
const double kEnoughToJudge = std::log(10.0);
}  // namespace

void SpectralRadius::set(double value) { value_ = std::clamp(value, 0.0, bound_); }

double SpectralRadius::that_leaves(double share, int n) {
  return 1.0 / std::cosh(std::acosh(1.0 / share) / n);
}

double SpectralRadius::promise(int n) const {
  // T_n(z) = cosh(n acosh z) for z >= 1, which overflows early.
  const double exponent = n * std::acosh(1.0 / value_);
  return exponent + std::log1p(std::exp(-2.0 * exponent)) - std::log(2.0);
}

bool SpectralRadius::lags(double ratio, int n) const {
  if (value_ <= 0.0 || n < 1 || !(ratio > 0.0)) return false;
  const double promised = promise(n);
  return promised > kEnoughToJudge && std::log(ratio) > -kDamping * promised;
}

void SpectralRadius::raise(double ratio, int n) {
  if (value_ <= 0.0 || n < 1 || !std::isfinite(ratio)) return;
  const double amplification = std::log(ratio) + promise(n);
  if (!(amplification > 0.0)) return;
  // acosh(exp L).
  const double reached = amplification + std::log1p(std::sqrt(-std::expm1(-2.0 * amplification)));
  set(value_ * std::cosh(reached / n));
}

void SpectralRadius::lower() { set(1.0 - 2.0 * (1.0 - value_)); }

}  // namespace pliant
