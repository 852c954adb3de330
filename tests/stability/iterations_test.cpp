#include "support/disturb.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class Iterations : public EverySolver {
 protected:
  ClothScene scene(int iterations) const {
    ClothScene scene;
    scene.material = soft_material();
    scene.solver = solver();
    scene.solver_parameters = with_iterations(solver(), iterations);
    return scene;
  }
};

// Without iterations nothing holds the particles together: each flies as a stone does. A step takes
// gravity's velocity at its end, hence a fall of g t (t + h) / 2.
TEST_P(Iterations, ZeroIsFreeFlight) {
  ClothScene scene = this->scene(0);
  scene.effects = {{"gravity", {}}};
  const auto world = make_world(scene);
  disturb(*world, 0.0, 0.5);
  const Particles start = particles_of(*world);
  run_for(*world, 0.5);
  const double t = world->time(), h = world->time_step();
  const Eigen::Vector3d fall(0, 0, -0.5 * 9.81 * t * (t + h));
  const Positions expected = (start.x + t * start.v).colwise() + fall;
  EXPECT_LT((particles_of(*world).x - expected).norm(), 1e-11);
  EXPECT_EQ(body_of(*world).report.iterations, 0);
}

TEST_P(Iterations, OneIsSoftButBounded) {
  ClothScene scene = this->scene(1);
  scene.effects = {{"gravity", {}}};
  scene.fixed = row_of(scene.grid, 6);
  const auto world = make_world(scene);
  disturb(*world, 0.005, 0.2);
  expect_no_free_motion(*world, 2.0);
}

// Converged implicit Euler never adds energy: x minimises |x - y|²_M / 2h² + E(x).
TEST_P(Iterations, TenThousandAddNoEnergy) {
  ClothScene scene = this->scene(10000);
  scene.effects = {{"gravity", {}}};
  scene.fixed = row_of(scene.grid, 6);
  const auto world = make_world(scene);
  disturb(*world, 0.002, 0.2);
  const double start = world->energies().total();
  EXPECT_LE(largest_energy(*world, 0.2), start);
  // All of them, unless round-off leaves nothing to do.
  const StepReport& report = body_of(*world).report;
  EXPECT_TRUE(report.iterations == 10000 || report.ended_by == EndedBy::kRoundOff);
  // What xpbd converges to leaves out how springs turn, which the residual holds.
  if (solver() != "xpbd") {
    EXPECT_LT(report.residual, 1e-9);
  }
}

// Iterations beyond convergence must not drift: multipliers and positions stay put.
TEST_P(Iterations, TenThousandEqualFiveThousand) {
  Positions ends[2];
  for (int k = 0; k < 2; ++k) {
    ClothScene scene = this->scene(k == 0 ? 5000 : 10000);
    scene.effects = {{"gravity", {}}};
    scene.fixed = row_of(scene.grid, 6);
    const auto world = make_world(scene);
    disturb(*world, 0.0, 0.2);
    run_for(*world, 0.05);
    ends[k] = particles_of(*world).x;
  }
  EXPECT_LT((ends[0] - ends[1]).norm(), 1e-10);
}

// A cloth between pins that drapes over what is below: however few the iterations, contact holds.
TEST_P(Iterations, NoneOneAndManyStayAboveThePlane) {
  for (const int iterations : {0, 1, 200}) {
    ClothScene scene = this->scene(iterations);
    scene.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
    scene.fixed = {0, 6};
    scene.obstacles = {obstacle(Plane(), at(0, 0, -0.1))};
    const auto world = make_world(scene);
    const double start = world->energies().total();
    for (int k = 0; k < (iterations > 1 ? 40 : 300); ++k) {
      ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
      ASSERT_GE(lowest(*world), -0.099 - 1e-9) << iterations;
      const Energies now = world->energies();
      ASSERT_LE(now.kinetic + now.potential, start + 1e-12) << iterations;
    }
  }
}

PLIANT_FOR_IMPLICIT_SOLVERS(Iterations);

}  // namespace
}  // namespace pliant
