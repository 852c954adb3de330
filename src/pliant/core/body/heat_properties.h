#pragma once

#include <optional>

namespace pliant {

/// What a body says of its own heat; the rest is as the effect `heat` says for all.
struct HeatProperties {
  std::optional<double> initial_temperature;  ///< [K]
  std::optional<double> melting_point;        ///< [K]
  std::optional<double> melting_range;        ///< [K]
  std::optional<double> latent_heat;          ///< [J/kg]
  std::optional<double> capacity;             ///< [J/(kg K)]
  std::optional<double> conductivity;         ///< [W/(m K)]
  std::optional<double> solid_beta;           ///< of what is not melted
};

}  // namespace pliant
