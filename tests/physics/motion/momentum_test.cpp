// Without outer forces momentum stays, and angular momentum as far as the integrator says.
#include <gtest/gtest.h>

#include <limits>

#include "support/random.h"
#include "support/worlds/worlds.h"

namespace pliant::momentum_test {
namespace {

ClothScene free_cloth(const std::string& solver, double dt, const ParameterText& parameters = {}) {
  ClothScene s;
  s.solver = solver;
  s.time_step = dt;
  s.material = {
      {"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "5"}, {"bending", "1e-4"}};
  s.solver_parameters = parameters;
  return s;
}

void stir(Particles& p, double speed) {
  Random random(4);
  p.v = random.positions(p.size(), speed);
}

/// Sum of the absolute momenta: what round-off is measured against.
double momentum_scale(const Particles& p) { return (p.v.colwise().norm() * p.mass)(0); }

/// Change of the momentum in 0.3 s, as a share of its scale.
double momentum_change(const std::string& solver, int iterations) {
  auto world = make_world(free_cloth(solver, 1e-3, with_iterations(solver, iterations)));
  Particles& p = particles_of(*world);
  stir(p, 0.5);
  const Eigen::Vector3d before = p.momentum();
  run_for(*world, 0.3);
  return (p.momentum() - before).norm() / momentum_scale(p);
}

class Momentum : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(Momentum);

TEST_P(Momentum, StaysToRoundOffOrAsIterationsConverge) {
  // Velocities round to 1e-16 m / h = 1e-13 m/s in each of 300 steps.
  const double round_off = 300 * 1e-13 / 0.5;
  if (keeps_momentum(solver())) {
    for (const int iterations : {1, 20}) {
      EXPECT_LE(momentum_change(solver(), iterations), round_off) << iterations;
    }
    return;
  }
  // An update that moves each particle by force over its own diagonal, not over its mass, keeps
  // momentum only as far as the iterations converge: here by a factor of two or more in every ten.
  double last = std::numeric_limits<double>::infinity();
  for (const int iterations : {20, 60, 120}) {
    const double change = momentum_change(solver(), iterations);
    EXPECT_LE(change, 0.1 * last + round_off) << iterations;
    last = change;
  }
  EXPECT_LE(last, 1e-9);
}

TEST(VerletAngularMomentum, StaysToRoundOff) {
  // x_{n+1} x v_{n+1} = x_n x v_{n+1}, and central forces add no torque at x_n: exact.
  auto world = make_world(free_cloth("verlet", 1e-3));
  Particles& p = particles_of(*world);
  stir(p, 0.5);
  const Eigen::Vector3d before = p.angular_momentum();
  run_for(*world, 0.3);
  EXPECT_LE((p.angular_momentum() - before).norm(), 300 * 1e-13 * p.mass.sum());
}

/// Share of the angular momentum that a cloth spinning in its plane keeps for 0.5 s.
double spin_kept(const std::string& solver, double dt) {
  auto world = make_world(free_cloth(solver, dt, converged(solver)));
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) p.v.col(i) << -3.0 * p.x(1, i), 3.0 * p.x(0, i), 0.0;
  const double before = p.angular_momentum().z();
  run_for(*world, 0.5);
  return p.angular_momentum().z() / before;
}

class ImplicitSpin : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(ImplicitSpin);

TEST_P(ImplicitSpin, LosesAngularMomentumToFirstOrder) {
  // Implicit Euler: dL = h² sum v x f per step, with the centripetal f = -m omega² x: L falls at
  // the rate h omega², 0.9 % in 0.5 s at h = 2 ms, and half of that at half the step.
  const double coarse = 1.0 - spin_kept(GetParam(), 2e-3);
  const double fine = 1.0 - spin_kept(GetParam(), 1e-3);
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(coarse, 2e-3 * 9.0 * 0.5, 0.3 * 2e-3 * 9.0 * 0.5);
  EXPECT_NEAR(coarse / fine, 2.0, 0.3);
}

}  // namespace
}  // namespace pliant::momentum_test
