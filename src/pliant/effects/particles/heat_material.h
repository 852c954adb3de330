#pragma once

#include <algorithm>

namespace pliant {

/// How a substance takes up heat and melts, over a range of temperatures about the melting point.
struct HeatMaterial {
  double capacity = 2000.0;      ///< c [J/(kg K)]
  double conductivity = 0.2;     ///< k [W/(m K)]
  double latent_heat = 1e5;      ///< L [J/kg]
  double melting_point = 305.0;  ///< middle of the range in which it melts [K]
  double melting_range = 4.0;    ///< > 0 [K]

  double solidus() const { return melting_point - 0.5 * melting_range; }
  double liquidus() const { return melting_point + 0.5 * melting_range; }
  /// Share that is liquid, 0 to 1.
  double liquid_share(double temperature) const {
    return std::clamp((temperature - solidus()) / melting_range, 0.0, 1.0);
  }
  /// Heat per mass above 0 K [J/kg].
  double enthalpy(double temperature) const {
    return capacity * temperature + latent_heat * liquid_share(temperature);
  }
  /// Its derivative; where it jumps, that of the warmer side [J/(kg K)].
  double slope(double temperature) const {
    const bool melts = temperature >= solidus() && temperature < liquidus();
    return melts ? capacity + latent_heat / melting_range : capacity;
  }
  /// The inverse of the enthalpy [K].
  double temperature(double enthalpy) const {
    const double begin = capacity * solidus(), end = capacity * liquidus() + latent_heat;
    if (enthalpy <= begin) return enthalpy / capacity;
    if (enthalpy >= end) return (enthalpy - latent_heat) / capacity;
    return solidus() + melting_range * (enthalpy - begin) / (end - begin);
  }
};

}  // namespace pliant
