// The law of trapped air.
#include "pliant/effects/air/air_gas.h"

#include <gtest/gtest.h>

namespace pliant::air_gas_test {
namespace {

constexpr double kAmount = 4e-4;  // [m³]

AirGas gas(double exponent) { return {101325.0, exponent}; }

TEST(AirGas, PressureIsWhatEnergyLosesWithVolume) {
  for (const double exponent : {1.0, 1.4}) {
    for (const double gauge : {-5e4, -100.0, 0.0, 100.0, 3e5}) {
      const AirGas air = gas(exponent);
      const double v = kAmount / air.squeeze(gauge), dv = 1e-5 * v;
      const double slope = (air.energy(kAmount, v + dv) - air.energy(kAmount, v - dv)) / (2.0 * dv);
      EXPECT_NEAR(-slope, gauge, 1e-5 * air.atmosphere) << exponent;
    }
  }
}

// Energy is convex in the volume: a step that ends with a pressure gets less work out of the air
// than the air loses, and has to give it more than the air takes up.
TEST(AirGas, PressureAtTheEndGivesLessThanEnergyLoses) {
  for (const double exponent : {1.0, 1.4}) {
    const AirGas air = gas(exponent);
    for (const double from : {0.1, 0.9, 1.5}) {
      for (const double gauge : {-5e4, -100.0, 0.0, 100.0, 3e5}) {
        const double v = kAmount / air.squeeze(gauge);
        const double lost = air.energy(kAmount, from * kAmount) - air.energy(kAmount, v);
        EXPECT_LE(gauge * (v - from * kAmount), lost + 1e-12) << exponent << " " << from;
      }
    }
  }
}

}  // namespace
}  // namespace pliant::air_gas_test
