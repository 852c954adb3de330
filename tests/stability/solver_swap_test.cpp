#include "support/stability_worlds.h"

namespace pliant {
namespace {

// Solvers share what a step hands on, positions and velocities, and keep nothing else: swapping in
// motion shows neither in a jump nor in energy. At a tenth of the largest explicit step, a = h w /
// 2 = 0.1, explicit energy swings by (1 + a) / (1 - a) = 1.22; implicit steps take some.
TEST(SolverSwap, EveryStepKeepsEnergyAndContinuity) {
  const std::vector<std::string> names = solver_registry().names_for("cloth");
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
