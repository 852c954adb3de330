// A mass on a spring against the closed form of each integrator: frequency and damping as theory
// says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "support/solvers/solvers.h"
#include "support/solvers/system_model.h"

namespace pliant::oscillator_test {
namespace {

constexpr double kMass = 0.3, kStiffness = 12.0, kAmplitude = 0.1;
const double kOmega = std::sqrt(kStiffness / kMass);

/// Elongations x_0 .. x_steps of a mass let go at kAmplitude with velocity `v`.
std::vector<double> swing(const std::string& solver, double h, int steps, double v = 0.0) {
  ParameterText parameters = converged(solver);
  if (solver == "verlet") parameters["max_substeps"] = "1";
  auto world = world_of(mass_on_spring(kMass, kStiffness, 1.0 + kAmplitude), h, solver, parameters);
  Particles& p = world->bodies().front().particles();
  p.v(0, 1) = v;
  std::vector<double> x{p.x(0, 1) - 1.0};
  for (int n = 0; n < steps; ++n) {
    EXPECT_TRUE(world->step());
    x.push_back(p.x(0, 1) - 1.0);
    EXPECT_EQ(p.x(1, 1), 0.0);
    EXPECT_EQ(p.x(2, 1), 0.0);
  }
  return x;
}

TEST(VerletOscillator, HasTheFrequencyOfTheArcsineLaw) {
  for (const double share : {0.05, 0.3, 1.0, 1.9}) {
    const double h = share / kOmega;
    const int steps = 1000;
    const std::vector<double> x = swing("verlet", h, steps);
    // x_{n+1} + x_{n-1} = 2 cos(theta) x_n with theta = 2 arcsin(omega h / 2): x_n = A cos(n theta
    // - phi)
    const double theta = 2.0 * std::asin(0.5 * kOmega * h);
    const double sine = (x[1] - x[0] * std::cos(theta)) / std::sin(theta);
    for (int n = 0; n <= steps; ++n) {
      const double exact = x[0] * std::cos(n * theta) + sine * std::sin(n * theta);
      // Round-off of 1e-16 m enters every step and adds up over n, divided by sin(theta).
      ASSERT_NEAR(x[static_cast<std::size_t>(n)], exact, 1e-15 * (n + 1) / std::sin(theta));
    }
  }
}

TEST(VerletOscillator, DoesNotDampAndGrowsAboveItsLimit) {
  const double theta_of_start = 0.5 * 0.5;  // from half a step back: a symmetric start
  const std::vector<double> stable = swing("verlet", 0.5 / kOmega, 20000);
  const double late = *std::max_element(stable.end() - 2000, stable.end());
  // Amplitude of the discrete solution through x_0 and x_1 = x_0 (1 - omega² h²).
  EXPECT_NEAR(late, kAmplitude / std::cos(std::asin(theta_of_start)), 1e-3 * kAmplitude);
  const std::vector<double> unstable = swing("verlet", 2.05 / kOmega, 20);
  // Grows by exp(2 arcosh(1.025)) = 1.56 a step.
  EXPECT_GT(std::abs(unstable.back()), 1e3 * kAmplitude);
}

class ImplicitOscillator : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(ImplicitOscillator);

TEST_P(ImplicitOscillator, HasImplicitEulersFrequencyAndDamping) {
  for (const double share : {0.05, 0.3, 1.0, 3.0}) {
    const double h = share / kOmega;
    const std::vector<double> x = swing(GetParam(), h, 300);
    // The state turns and shrinks by 1 / (1 + i omega h): x_n = A cos(n arctan(omega h)) / (1 +
    // omega² h²)^(n/2)
    const std::complex<double> factor = 1.0 / std::complex<double>(1.0, kOmega * h);
    std::complex<double> z = kAmplitude;
    for (int n = 0; n <= 300; ++n, z *= factor) {
      // Round-off of lengths of 1 m.
      ASSERT_NEAR(x[static_cast<std::size_t>(n)], z.real(), 2e-16 * (n + 1) * (n + 1) + 1e-15);
    }
  }
}

/// Error at time 1 s against A cos(omega t) for a step of `h`.
double error(const std::string& solver, double h) {
  // Verlet's velocity lives half a step back: v(-h/2) = A omega sin(omega h / 2).
  const double v = is_explicit(solver) ? kAmplitude * kOmega * std::sin(0.5 * kOmega * h) : 0.0;
  const int steps = static_cast<int>(std::lround(1.0 / h));
  return std::abs(swing(solver, h, steps, v).back() - kAmplitude * std::cos(kOmega));
}

TEST(Order, VerletIsOfSecondOrder) {
  EXPECT_NEAR(error("verlet", 0.01) / error("verlet", 0.005), 4.0, 0.1);
  EXPECT_NEAR(error("verlet", 0.005) / error("verlet", 0.0025), 4.0, 0.05);
}

TEST_P(ImplicitOscillator, IsOfFirstOrder) {
  EXPECT_NEAR(error(GetParam(), 2e-4) / error(GetParam(), 1e-4), 2.0, 0.05);
}

TEST_P(ImplicitOscillator, HangsWhereTheSpringBearsTheWeight) {
  // m g = k (l - 1) at rest, whatever the step; 400 s of implicit damping, omega² h / 2 >= 1 1/s.
  // (At steps above 0.5 s the step's objective has a second minimum within reach of its prediction,
  // with the mass on the spring's other side.)
  for (const double h : {0.05, 0.3}) {
    auto world =
        world_of(mass_on_spring(kMass, kStiffness, 1.0), h, GetParam(), converged(GetParam()));
    AppliedForce weight;
    weight.point = Eigen::Vector3d(1, 0, 0);
    weight.force = Eigen::Vector3d(9.81 * kMass, 0, 0);
    weight.duration = -1.0;
    world->applied_forces().add(weight);
    while (world->time() < 400.0) ASSERT_TRUE(world->step());
    const double length = world->bodies().front().particles().x(0, 1);
    EXPECT_NEAR(length, 1.0 + 9.81 * kMass / kStiffness, 1e-12);
  }
}

}  // namespace
}  // namespace pliant::oscillator_test
