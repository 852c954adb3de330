#include "pliant/solvers/spectral_radius.h"

#include <algorithm>
#include <cmath>

namespace pliant {

void SpectralRadius::set(double value) { value_ = std::clamp(value, 0.0, bound_); }

void SpectralRadius::raise(double ratio, int n) {
  if (value_ <= 0.0 || n < 1 || !std::isfinite(ratio)) return;
  // T_n(z) = cosh(n acosh z) for z >= 1.
  const double amplification = ratio * std::cosh(n * std::acosh(1.0 / value_));
  if (!(amplification > 1.0) || !std::isfinite(amplification)) return;
  set(value_ * std::cosh(std::acosh(amplification) / n));
}

void SpectralRadius::lower() { set(1.0 - 2.0 * (1.0 - value_)); }

}  // namespace pliant
