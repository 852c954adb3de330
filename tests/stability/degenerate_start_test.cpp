// Degenerate and scrambled starts.
#include <gtest/gtest.h>

#include "support/disturb.h"
#include "support/meshes/intersections.h"
#include "support/random.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class DegenerateStart : public EverySolver {
 protected:
  std::unique_ptr<World> free_cloth() const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.effects = {{"damping", {{"rate", "5"}}}};
    s.time_step = half_step(s);
    return make_world(s);
  }

  /// Half the largest stable step of an explicit solver, the usual one for the others.
  static double half_step(const ClothScene& scene) {
    return is_explicit(scene.solver) ? 0.5 * stable_step(scene) : scene.time_step;
  }

  /// A cloth above a plane that it falls on, made by `place` from where the grid's vertices are.
  template <class Place>
  std::unique_ptr<World> above_plane(const Place& place) const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.obstacles = {obstacle(Plane())};
    s.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
    s.time_step = half_step(s);
    auto world = make_world(s);
    Positions& x = particles_of(*world).x;
    for (int i = 0; i < x.cols(); ++i) x.col(i) = place(x.col(i).eval());
    world->set_initial_state();
    return world;
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

// Folded in half, each vertex of one layer where the other's is: nothing says which one is above,
// and without self-contact nothing parts them. They do the same, to the last bits.
TEST_P(DegenerateStart, FoldedExactlyOnItself) {
  auto world = above_plane(
      [](const Eigen::Vector3d& x) { return Eigen::Vector3d(std::abs(x.x()), x.y(), 0.02); });
  const double start = world->energies().total();
  const Positions& x = particles_of(*world).x;
  EXPECT_LE(largest_energy(*world, 0.5), energy_swing(GetParam()) * start);
  EXPECT_GE(lowest(*world), 0.001 - 1e-9);
  double parted = 0.0;
  for (int r = 0; r < 7; ++r) {
    for (int c = 0; c < 3; ++c) {
      parted = std::max(parted, (x.col(7 * r + c) - x.col(7 * r + 6 - c)).norm());
    }
  }
  EXPECT_LT(parted, 1e-6);
}

// A curtain that falls on its hem folds up: triangles without area, edges without length.
TEST_P(DegenerateStart, CurtainFallsOnItsHem) {
  auto world = above_plane(
      [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.x(), 0.0, x.y() + 0.16); });
  const double start = world->energies().total();
  for (int k = 0; world->time() < 1.0; ++k) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    ASSERT_LE(world->energies().total(), energy_swing(GetParam()) * start) << world->time();
    ASSERT_GE(lowest(*world), 0.001 - 1e-9);
    // Nothing pushes it out of its plane: it collapses within it.
    ASSERT_TRUE(particles_of(*world).x.row(1).isZero(1e-9));
  }
  EXPECT_LT(particles_of(*world).x.row(2).minCoeff(), 0.002);
}

// The same with all that keeps it out of itself: it may buckle out of its plane then.
TEST_P(DegenerateStart, CurtainFallsOnItsHemAndKeepsOutOfItself) {
  ClothScene s;
  s.solver = GetParam();
  s.material = soft_material();
  s.pose = at(0, 0, 0.16) * Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitX());
  s.obstacles = {obstacle(Plane())};
  s.effects = {{"gravity", {}},
               {"damping", {}},
               {"self_contact", {{"thickness", "0.004"}}},
               {"contact", {{"thickness", "0.004"}}},
               {"friction", {}}};
  s.time_step = half_step(s);
  const auto world = make_world(s);
  const double start = world->energies().total();
  while (world->time() < 0.6) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    const Energies now = world->energies();
    ASSERT_LE(now.kinetic + now.potential, energy_swing(GetParam()) * start) << world->time();
    ASSERT_GE(lowest(*world), 0.002 - 1e-9);
    ASSERT_EQ(
        count_intersections(particles_of(*world).x, body_of(*world).model->surface_triangles()), 0)
        << world->time();
  }
}

}  // namespace
}  // namespace pliant
