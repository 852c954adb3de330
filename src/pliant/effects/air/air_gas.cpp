#include "pliant/effects/air/air_gas.h"

#include <algorithm>
#include <cmath>

namespace pliant {

double AirGas::squeeze(double gauge) const {
  const double share = (atmosphere + gauge) / atmosphere;
  return exponent == 1.0 ? share : std::pow(std::max(0.0, share), 1.0 / exponent);
}

double AirGas::squeeze_slope(double gauge) const {
  const double pressure = std::max(atmosphere + gauge, kTinyShare * atmosphere);
  return squeeze(gauge) / (exponent * pressure);
}

double AirGas::energy(double amount, double volume) const {
  if (volume <= 0.0) return 0.0;
  if (exponent == 1.0) {
    const double inner = amount > 0.0 ? amount * std::log(volume / amount) : 0.0;
    return atmosphere * (volume - amount - inner);
  }
  const double inner = atmosphere * (amount * std::pow(amount / volume, exponent - 1.0) - amount);
  return atmosphere * (volume - amount) + inner / (exponent - 1.0);
}

}  // namespace pliant
