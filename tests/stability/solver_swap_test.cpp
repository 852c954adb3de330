#include "support/disturb.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/snapshot.h"

namespace pliant {
namespace {

/// A cloth that falls on a ball on a plane, at a step that is stable for every solver.
ClothScene draped() {
  ClothScene scene;
  scene.material = soft_material();
  scene.solver = "verlet";
  scene.obstacles = {obstacle(Plane()), obstacle(Sphere(0.05), at(0.01, 0, 0.05))};
  scene.pose = at(0, 0, 0.11);
  scene.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
  scene.time_step = 0.1 * stable_step(scene);
  return scene;
}

using SwapToItself = EverySolver;

// Solvers share what a step hands on, positions and velocities, and keep nothing else: swapping in
// motion shows neither in a jump nor in energy. At a tenth of the largest explicit step, a = h w /
// 2 = 0.1, explicit energy swings by (1 + a) / (1 - a) = 1.22; implicit steps take some.
TEST(SolverSwap, EveryStepKeepsEnergyAndContinuity) {
  const std::vector<std::string> names = cloth_solvers();
  ClothScene scene;
  scene.material = soft_material();
  scene.solver = "verlet";
  scene.fixed = {0, 48};
  scene.time_step = 0.1 * stable_step(scene);
  const auto world = make_world(scene);
  disturb(*world, 0.003, 0.5);
  const double start = world->energies().total();
  const Particles& particles = particles_of(*world);
  // All the energy in the lightest particle bounds every speed.
  const double fastest = std::sqrt(2.0 * 1.22 * start / particles.mass.minCoeff());
  for (std::size_t k = 0; k < 300; ++k) {
    const Snapshot before(*world);
    world->set_solver(body_of(*world), solver_registry(), names[k % names.size()], {}, "test");
    before.expect_equal(*world);
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    ASSERT_EQ(body_of(*world).report.solver, names[k % names.size()]);
    ASSERT_TRUE(body_of(*world).report.warnings.empty());
    const double jump = (particles.x - before.x).colwise().norm().maxCoeff();
    ASSERT_LE(jump, fastest * world->time_step()) << "step " << k;
    ASSERT_LE(world->energies().total(), 1.22 * start) << "step " << k;
  }
}

// In the middle of a fall on a ball, with friction: no swap may add energy, nor let go of a
// contact.
TEST(SolverSwap, InContactKeepsEnergyAndDistance) {
  const std::vector<std::string> names = cloth_solvers();
  ClothScene scene = draped();
  const auto world = make_world(scene);
  run_for(*world, 0.15);
  const double start = world->energies().total();
  for (std::size_t k = 0; k < 100 * names.size(); ++k) {
    const Snapshot before(*world);
    world->set_solver(body_of(*world), solver_registry(), names[k % names.size()], {}, "test");
    before.expect_equal(*world);
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    ASSERT_LE(world->energies().total(), 1.22 * start) << names[k % names.size()];
    for (const Obstacle& solid : world->obstacles()) {
      for (int i = 0; i < particles_of(*world).size(); ++i) {
        const Eigen::Vector3d x = solid.pose_end.inverse() * particles_of(*world).x.col(i);
        ASSERT_GE(solid.shape->distance(x), 0.001 - 1e-5) << names[k % names.size()];
      }
    }
  }
}

// A solver keeps nothing that a swap would lose, not even for itself.
TEST_P(SwapToItself, ChangesNothing) {
  ClothScene scene = draped();
  scene.solver = solver();
  const auto swapped = make_world(scene), alone = make_world(scene);
  for (int k = 0; k < 200; ++k) {
    swapped->set_solver(body_of(*swapped), solver_registry(), solver(), {}, "test");
    ASSERT_TRUE(swapped->step());
    ASSERT_TRUE(alone->step());
  }
  Snapshot(*alone).expect_equal(*swapped);
}

PLIANT_FOR_EVERY_SOLVER(SwapToItself);

// A step whose parameters are refused leaves the solver that was there.
TEST(SolverSwap, RefusedSwapChangesNothing) {
  ClothScene scene;
  const auto world = make_world(scene);
  run_for(*world, 0.02);
  const Snapshot before(*world);
  EXPECT_ANY_THROW(world->set_solver(body_of(*world), solver_registry(), "xpdb", {}, "test"));
  EXPECT_ANY_THROW(world->set_solver(body_of(*world), solver_registry(), "jacobi",
                                     {{"iterations", "-1"}}, "test"));
  EXPECT_EQ(body_of(*world).solver->name(), "xpbd");
  before.expect_equal(*world);
  run_for(*world, 0.02);
}

}  // namespace
}  // namespace pliant
