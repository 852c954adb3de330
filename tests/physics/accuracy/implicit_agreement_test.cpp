// All solvers of implicit Euler minimise the same objective: where they converge they agree, from
// cold and from warm, with contact, friction and air as without.
#include <gtest/gtest.h>

#include "pliant/effects/contact/contact.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/step_scenes.h"

namespace pliant::implicit_agreement_test {
namespace {

std::vector<std::string> minimisers() {
  return {"jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev", "direct", "lbfgs",
          "newton"};
}

// Near the solution |e| in the norm of the Hessian is at most sqrt(κ) |r| in that of D^-1, with κ
// the largest D h²/m, here up to 1e4: residuals of 1e-11 leave errors of some 1e-9.
const ParameterText kConverged{{"iterations", "200000"}, {"tolerance", "1e-11"}};
constexpr double kAgreement = 1e-6;

/// After a start from there: what is warm has no use for more.
int steps_that_warm(const std::string& from) { return from == "cold" ? 1 : 0; }

class AgreementOn : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, AgreementOn, testing::ValuesIn(step_problems()), problem_name);

TEST_P(AgreementOn, FromColdAndFromWarm) {
  const StepProblem& problem = GetParam();
  const ProjectiveSystem exact = after_converged_step(problem);
  const Particles& p = exact.particles;
  const double distance = (p.x - p.x_start).norm();
  const double value = objective_after(exact, problem.dt);
  for (const std::string& name : minimisers()) {
    ProjectiveSystem system = problem.make();
    const Particles start = system.particles;
    const auto solver = make_solver(name, kConverged);
    solver->prepare(system, problem.dt);
    for (const char* from : {"cold", "warm"}) {
      SCOPED_TRACE(name + std::string(" from ") + from);
      system.particles = start;
      const StepReport report = step_of(system, *solver, problem.dt);
      EXPECT_EQ(report.ended_by, EndedBy::kTolerance) << report.residual;
      EXPECT_LE((system.particles.x - p.x).norm(), kAgreement * distance);
      EXPECT_LE((system.particles.v - p.v).norm(), kAgreement * distance / problem.dt);
      // The objective's error is half the square of that of the positions.
      EXPECT_NEAR(objective_after(system, problem.dt), value, 1e-12 * value);
      // Warm: after another step, whatever it learned and kept from it.
      for (int k = 0; k < steps_that_warm(from); ++k) step_of(system, *solver, problem.dt);
    }
  }
}

TEST_P(AgreementOn, AStepFromTheSolutionWithNothingToDoStays) {
  // At rest in balance, the solution is where the step begins.
  const StepProblem& problem = GetParam();
  ProjectiveSystem solved = after_converged_step(problem);
  Forces f = Forces::Zero(3, solved.particles.size());
  for (const auto& set : solved.elements) set->add_forces(solved.particles.x, f);
  for (const std::string& name : minimisers()) {
    ProjectiveSystem system = problem.make();
    system.particles = solved.particles;
    system.particles.v.setZero();
    // What the elements pull is held: the prediction moves away, the solution does not.
    system.external_forces = -f;
    step_of(system, name, kConverged, problem.dt);
    const double off = (system.particles.x - solved.particles.x).norm();
    EXPECT_LE(off, 1e-9 * solved.particles.x.norm()) << name;
  }
}

std::vector<StepScene> cloth_scenes() {
  std::vector<StepScene> scenes;
  for (const StepScene& scene : step_scenes()) {
    for (const char* name : {"soft_coarse", "default_coarse", "contact", "contact_and_friction"}) {
      if (scene.name == name) scenes.push_back(scene);
    }
  }
  StepScene air = tent_scene();
  air.name = "contact_and_air";
  air.scene.effects.pop_back();
  scenes.push_back(air);
  return scenes;
}

class AgreementOfCloth : public testing::TestWithParam<StepScene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, AgreementOfCloth, testing::ValuesIn(cloth_scenes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(AgreementOfCloth, FromColdAndFromWarm) {
  const StepScene& scene = GetParam();
  const auto reference = world_before_step(scene, "newton", kConverged);
  ASSERT_TRUE(reference->step());
  const Particles& p = particles_of(*reference);
  // What contact holds moves little: errors are measured against what the step would do without.
  const double dt = scene.scene.time_step;
  const double distance = dt * p.v_start.norm() + dt * dt * 9.81 * std::sqrt(p.size());
  const Energies energies = reference->energies();
  for (const std::string& name : minimisers()) {
    const auto world = world_before_step(scene, name, kConverged);
    for (const char* from : {"cold", "warm"}) {
      SCOPED_TRACE(name + std::string(" from ") + from);
      particles_of(*world) = begin_of_step(scene);
      ASSERT_TRUE(world->step());
      EXPECT_EQ(body_of(*world).report.ended_by, EndedBy::kTolerance);
      EXPECT_EQ(body_of(*world).report.contacts, body_of(*reference).report.contacts);
      EXPECT_LE((particles_of(*world).x - p.x).norm(), kAgreement * distance);
      EXPECT_NEAR(world->energies().elastic, energies.elastic, kAgreement * energies.elastic);
      for (int k = 0; k < steps_that_warm(from); ++k) ASSERT_TRUE(world->step());
    }
  }
}

/// A tent pulls in what lies around it: with the default friction nearly all of that slides, with
/// three times as much nearly all sticks.
struct TentFriction {
  const char* name;
  double coefficient;
};

class Coulomb : public testing::TestWithParam<std::tuple<std::string, TentFriction>> {};
INSTANTIATE_TEST_SUITE_P(
    Solvers, Coulomb,
    testing::Combine(testing::ValuesIn(minimisers()),
                     testing::Values(TentFriction{"sliding", 0.5}, TentFriction{"stuck", 1.5})),
    [](const auto& info) { return std::get<0>(info.param) + "_" + std::get<1>(info.param).name; });

TEST_P(Coulomb, HoldsWhereEverythingActs) {
  // Coulomb's law may allow more than one answer, and solvers may find different ones: with
  // contact, friction and air each must be an answer.
  const auto& [solver, friction] = GetParam();
  StepScene scene = tent_scene();
  scene.name += std::string("_") + friction.name;
  scene.scene.effects.back().second = {{"coefficient", std::to_string(friction.coefficient)}};
  const auto world = world_before_step(scene, solver, kConverged);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).report.ended_by, EndedBy::kTolerance);
  const Particles& p = particles_of(*world);
  const auto& system = projective_system(*body_of(*world).model);
  Forces balance = unbalanced_after(system, scene.scene.time_step);
  for (const Constraint* constraint : system.constraints) constraint->add_forces(balance);
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) balance.col(i).setZero();
  }
  double load = 0.0;
  int stuck = 0, sliding = 0;
  for (const Contact& contact : effect_of<ContactEffect>(*world, "contact").contacts()) {
    const Eigen::Vector3d& n = contact.normal;
    EXPECT_GE(n.dot(p.x.col(contact.point)), contact.plane - 1e-12);
    EXPECT_GE(contact.normal_force, 0.0);
    if (contact.normal_force <= 0.0) continue;
    load += contact.normal_force;
    Eigen::Vector3d slip = p.x.col(contact.point) - p.x_start.col(contact.point);
    slip -= n * n.dot(slip);
    const double bound = friction.coefficient * contact.normal_force;
    const double force = contact.friction_force.norm();
    EXPECT_LE(force, bound * (1.0 + 1e-12));
    if (force < bound * (1.0 - 1e-9)) {
      ++stuck;
      EXPECT_LE(slip.norm(), 1e-9) << contact.point;
    } else if (slip.norm() > 1e-9) {
      ++sliding;
      EXPECT_NEAR(slip.normalized().dot(contact.friction_force) / force, -1.0, 1e-6);
    }
  }
  EXPECT_LE(balance.norm(), 1e-9 * load);
  // Of 168 points.
  EXPECT_GT(friction.coefficient < 1.0 ? sliding : stuck, 100);
}

}  // namespace
}  // namespace pliant::implicit_agreement_test
