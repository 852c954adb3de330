#include "pliant/solvers/spectral_radius.h"

#include <algorithm>
#include <cmath>

namespace pliant {

void SpectralRadius::set(double value) { value_ = std::clamp(value, 0.0, bound_); }

void SpectralRadius::raise(double ratio, int n) {
  if (value_ <= 0.0 || n < 1 || !std::isfinite(ratio)) return;
  // L = log(ratio T_n(1/ρ)), with T_n(z) = cosh(n acosh z) for z >= 1, which overflows early.
  const double promised = n * std::acosh(1.0 / value_);
  const double amplification =
      std::log(ratio) + promised + std::log1p(std::exp(-2.0 * promised)) - std::log(2.0);
  if (!(amplification > 0.0)) return;
  // acosh(exp L).
  const double reached = amplification + std::log1p(std::sqrt(-std::expm1(-2.0 * amplification)));
  set(value_ * std::cosh(reached / n));
}

void SpectralRadius::lower() { set(1.0 - 2.0 * (1.0 - value_)); }

}  // namespace pliant
