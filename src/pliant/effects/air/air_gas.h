#pragma once

namespace pliant {

/// A sealed amount of air, p V^γ = p_a V_0^γ: Boyle, or adiabatic.
struct AirGas {
  double atmosphere = 101325.0;  ///< p_a [Pa]
  double exponent = 1.0;         ///< γ; 1 isothermal
  /// Of the atmosphere's pressure: a vacuum is as stiff as this.
  static constexpr double kTinyShare = 1e-6;

  /// V_0 / V, the volume of the air at atmospheric pressure over that at a `gauge` pressure p - p_a
  /// [Pa]; 0 below a vacuum.
  double squeeze(double gauge) const;
  /// Its derivative by the pressure [1/Pa]; a vacuum's counts as that of kTinyShare.
  double squeeze_slope(double gauge) const;
  /// Work against the atmosphere less what the air gives, ∫ (p_a - p) dV from V_0 = `amount` to
  /// `volume` [m³] [J].
  double energy(double amount, double volume) const;
};

}  // namespace pliant
