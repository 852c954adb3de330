// Degenerate and scrambled starts.
#include <gtest/gtest.h>

#include "support/bounds.h"
#include "support/random.h"

namespace pliant {
namespace {

class DegenerateStart : public EverySolver {
 protected:
  std::unique_ptr<World> free_cloth() const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.time_step = GetParam() == "verlet" ? 1e-3 : 0.005;
    s.effects = {{"damping", {{"rate", "5"}}}};
    return make_world(s);
  }
};
PLIANT_FOR_EVERY_SOLVER(DegenerateStart);

TEST_P(DegenerateStart, AllVerticesAtOnePoint) {
  auto world = free_cloth();
  particles_of(*world).x.setZero();
  // Nothing says where to go: springs without direction exert no force.
  expect_bounded(*world, 200, 1.0);
}

TEST_P(DegenerateStart, AllVerticesAlmostAtOnePoint) {
  auto world = free_cloth();
  Random random(2);
  particles_of(*world).x = random.positions(49, 1e-9);
  const double energy = world->energies().total();
  expect_bounded(*world, 400, 2.0);
  EXPECT_LE(world->energies().total(), energy);
}

TEST_P(DegenerateStart, AllVerticesOnALine) {
  auto world = free_cloth();
  particles_of(*world).x.bottomRows(2).setZero();
  expect_bounded(*world, 400, 1.0);
}

TEST_P(DegenerateStart, NeighboursCoincide) {
  auto world = free_cloth();
  Particles& p = particles_of(*world);
  for (int i = 0; i + 1 < 49; i += 2) p.x.col(i + 1) = p.x.col(i);
  const double energy = world->energies().elastic;
  expect_bounded(*world, 600, 1.0);
  EXPECT_LE(world->energies().elastic, 0.5 * energy);
}

TEST_P(DegenerateStart, ARandomScrambleComesToRest) {
  auto world = free_cloth();
  Random random(3);
  particles_of(*world).x = random.positions(49, 0.3);
  const double energy = world->energies().elastic;
  double lowest = energy;
  for (int k = 0; k < 6; ++k) {
    run_for(*world, 0.5);
    const double now = world->energies().total();
    EXPECT_LE(now, lowest * (1.0 + 1e-6)) << k;
    lowest = now;
  }
  // It may stay folded, but its springs relax and nothing moves any more.
  EXPECT_LE(world->energies().elastic, 0.02 * energy);
  EXPECT_LE(world->energies().kinetic, 1e-4 * energy);
  EXPECT_LE(extent(*world), 1.0);
}

TEST_P(DegenerateStart, TurnedInsideOut) {
  auto world = free_cloth();
  particles_of(*world).x.row(0) *= -1.0;
  const Positions mirrored = particles_of(*world).x;
  expect_bounded(*world, 200, 0.3);
  // A mirrored flat sheet is at rest: round-off only.
  EXPECT_LE((particles_of(*world).x - mirrored).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace pliant
