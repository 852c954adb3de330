#include "support/disturb.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/snapshot.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class TimeSteps : public EverySolver {
 protected:
  ClothScene hanging(double dt, int iterations) const {
    ClothScene scene;
    scene.material = soft_material();
    scene.effects = {{"gravity", {}}};
    scene.fixed = row_of(scene.grid, 6);
    scene.solver = solver();
    scene.solver_parameters = up_to_iterations(solver(), iterations);
    scene.time_step = dt;
    return scene;
  }

  void expect_to_lie_still(double dt) const {
    ClothScene scene = hanging(dt, 0);
    scene.solver_parameters.clear();
    scene.fixed.clear();
    scene.pose = at(0, 0, 0.001);
    scene.obstacles = {obstacle(Plane())};
    scene.effects = {{"gravity", {}},  {"damping", {}},      {"strain_limit", {{"max", "1.01"}}},
                     {"air", {}},      {"self_contact", {}}, {"contact", {}},
                     {"friction", {}}, {"wetness", {}}};
    const auto world = make_world(scene);
    const Positions start = particles_of(*world).x;
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    EXPECT_LT((particles_of(*world).x - start).cwiseAbs().maxCoeff(), 1e-6) << dt;
  }
};

class ExplicitTimeSteps : public TimeSteps {};

// Implicit Euler adds no energy at any step; gravity's work is in the potential energy. At 1 s one
// iteration is far from converged, hence the many.
TEST_P(TimeSteps, AddNoEnergyFromMicrosecondsToSeconds) {
  for (double dt : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
    const auto world = make_world(hanging(dt, dt > 0.005 ? 3000 : 300));
    disturb(*world, 0.002, 0.2);
    const double start = world->energies().total();
    // Round-off of a position, over h, is one of a velocity: at 1 µs some 1e-10 m/s.
    const double round_off = 1e-8 * world->energies().kinetic;
    EXPECT_LE(largest_energy(*world, 100 * dt), start + round_off) << dt;
  }
}

// The default iterations must be safe too, wherever a user puts the step.
TEST_P(TimeSteps, KeepKineticEnergyBoundedByDefault) {
  for (double dt : {1e-6, 1e-3, 1e-2, 1.0 / 30, 0.1, 1.0}) {
    ClothScene scene = hanging(dt, 0);
    scene.solver_parameters.clear();
    const auto world = make_world(scene);
    disturb(*world, 0.002, 0.2);
    SCOPED_TRACE(dt);
    expect_no_free_motion(*world, 200 * dt, 1e-8);
  }
}

// Every effect of cloth, with no air between cloth and plane, at any step: it lies still.
TEST_P(TimeSteps, LieStillWithEveryEffect) {
  for (double dt : {1e-6, 1e-4, 1e-2, 1.0 / 30, 0.1, 1.0}) expect_to_lie_still(dt);
}

TEST_P(ExplicitTimeSteps, LieStillWithEveryEffect) {
  for (double dt : {1e-6, 0.5 * stable_step(hanging(0.05, 0))}) expect_to_lie_still(dt);
}

// Position Verlet keeps v²/2 - h w² x v / 2 + w² x² / 2 of a mode w exactly, so that the energy
// taken from x and the velocity half a step before swings by (1 + a) / (1 - a) at most, a = h w /
// 2: by 3 at half the largest step.
TEST_P(ExplicitTimeSteps, EnergySwingsWithinItsBound) {
  ClothScene scene = hanging(0.05, 0);
  scene.effects.clear();
  scene.time_step = 0.5 * stable_step(scene);
  for (double dt : {1e-6, scene.time_step}) {
    scene.time_step = dt;
    const auto world = make_world(scene);
    disturb(*world, 0.002, 0.2);
    const double start = world->energies().total();
    EXPECT_LE(largest_energy(*world, 2000 * dt), 3.0 * start) << dt;
    EXPECT_TRUE(body_of(*world).report.warnings.empty());
  }
}

TEST_P(ExplicitTimeSteps, WarnsAboveTheLimitAndIsUndone) {
  ClothScene scene = hanging(0.05, 0);
  scene.time_step = 4.0 * stable_step(scene);
  scene.solver_parameters = {{"max_substeps", "1"}};
  const auto world = make_world(scene);
  disturb(*world, 0.002, 0.2);
  for (int k = 0; k < 5000; ++k) {
    const Snapshot before(*world);
    const bool kept = world->step();
    ASSERT_TRUE(warns(*world, "unstable_step"));
    if (kept) continue;
    before.expect_equal(*world);
    EXPECT_NE(body_of(*world).report.failure.find("vertex"), std::string::npos);
    EXPECT_NE(body_of(*world).report.failure.find("time step"), std::string::npos);
    return;
  }
  FAIL() << "an unstable step did not blow up";
}

PLIANT_FOR_IMPLICIT_SOLVERS(TimeSteps);
PLIANT_FOR_EXPLICIT_SOLVERS(ExplicitTimeSteps);

}  // namespace
}  // namespace pliant
