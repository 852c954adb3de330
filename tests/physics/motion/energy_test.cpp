// With damping and no outer work energy never rises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant::energy_test {
namespace {

class DampedCloth : public EverySolver {
 protected:
  ClothScene scene() const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.solver_parameters = converged(GetParam());
    s.time_step = 1e-3;
    s.effects = {{"gravity", {}}, {"damping", {{"rate", "2"}}}};
    return s;
  }

  /// Steps for `seconds`; energy may exceed what it was before by no more than the bound.
  static void expect_falling(World& world, double seconds) {
    double lowest = world.energies().total(), kinetic = world.energies().kinetic;
    const double scale = std::abs(lowest) + kinetic;
    double exchange = 0.0;  // largest change of kinetic energy in a step
    for (int k = 0; k < std::lround(seconds / world.time_step()); ++k) {
      ASSERT_TRUE(world.step());
      const Energies e = world.energies();
      exchange = std::max(exchange, std::abs(e.kinetic - kinetic));
      kinetic = e.kinetic;
      // Verlet's velocity lives half a step back: a step's exchange shows as an oscillation.
      // Implicit steps only lose; 1e-9 is what contact leaves of convergence.
      const double bound = is_explicit(GetParam()) ? exchange : 1e-9 * scale;
      ASSERT_LE(e.total(), lowest + bound) << "at " << world.time() << " s";
      lowest = std::min(lowest, e.total());
    }
  }
};
PLIANT_FOR_EVERY_SOLVER(DampedCloth);

TEST_P(DampedCloth, SwingingFromTwoCorners) {
  ClothScene s = scene();
  s.fixed = {0, 6};
  s.pose = at(0, 0, 1);
  auto world = make_world(s);
  const double start = world->energies().total();
  expect_falling(*world, 1.5);
  EXPECT_LT(world->energies().total(), start);
}

TEST_P(DampedCloth, FallingOnASphereAndAPlane) {
  ClothScene s = scene();
  s.obstacles = {obstacle(Plane()), obstacle(Sphere(0.05), at(0.01, 0.02, 0.05))};
  s.pose = at(0, 0, 0.15);
  s.effects.push_back({"contact", {}});
  s.effects.push_back({"friction", {}});
  auto world = make_world(s);
  expect_falling(*world, 0.6);
}

TEST_P(DampedCloth, StretchedAndLetGo) {
  ClothScene s = scene();
  s.effects = {{"damping", {{"rate", "2"}}}};
  auto world = make_world(s);
  particles_of(*world).x *= 1.3;
  expect_falling(*world, 0.5);
}

TEST(VerletEnergy, IsKeptWithoutDamping) {
  // Symplectic: no drift over many periods, only the half step's oscillation.
  ClothScene s;
  s.solver = "verlet";
  s.material = soft_material();
  s.time_step = 5e-4;
  auto world = make_world(s);
  particles_of(*world).x *= 1.02;
  const double start = world->energies().total();
  double sum = 0.0;
  run_for(*world, 1.0);
  for (int k = 0; k < 2000; ++k) {
    ASSERT_TRUE(world->step());
    sum += world->energies().total();
  }
  // The highest mode has h omega = 0.3: its energy is off by (h omega)² / 4, 2 %.
  EXPECT_NEAR(sum / 2000.0 / start, 1.0, 0.02);
}

}  // namespace
}  // namespace pliant::energy_test
