// Chebyshev acceleration: its recurrence on a linear problem, and what it makes of the radius.
#include "pliant/solvers/iterations/chebyshev.h"

#include <gtest/gtest.h>

#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/math/symmetric_eigen.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/step_scenes.h"

namespace pliant {
namespace {

/// J(y) of a linear problem: y + gamma D^-1 (b - A y).
class LinearJacobi {
 public:
  LinearJacobi(const StepProblem& problem, double gamma)
      : start_(after_step(problem, "jacobi", iterations(0))), dt_(problem.dt), gamma_(gamma) {
    diagonal_ = dense_matrix(start_, dt_).diagonal();
  }
  Positions operator()(const Positions& y) {
    start_.particles.x = y;
    const Forces r = unbalanced_after(start_, dt_);
    return y + gamma_ * r * free_mobility(diagonal_, start_.particles).asDiagonal();
  }
  /// |J(y) - y| in the norm of D.
  double change(const Positions& after, const Positions& y) const {
    return ((after - y) * diagonal_.cwiseSqrt().asDiagonal()).norm();
  }
  /// The largest of |eigenvalues| of I - gamma D^-1 A over free particles.
  double radius() const {
    Eigen::MatrixXd a = dense_matrix(start_, dt_);
    const Eigen::VectorXd scale = diagonal_.cwiseSqrt().cwiseInverse();
    a = scale.asDiagonal() * a * scale.asDiagonal();
    const Eigen::VectorXd values = symmetric_eigenvalues(a);
    return (1.0 - gamma_ * values.array()).abs().maxCoeff();
  }

 private:
  ProjectiveSystem start_;
  double dt_;
  double gamma_;
  Eigen::VectorXd diagonal_;
};

TEST(Chebyshev, IsWangsRecurrence) {
  const StepProblem problem = linear_problem();
  constexpr int kDelay = 4, kMost = 60;
  constexpr double kRho = 0.9;
  const ParameterText options{{"spectral_radius", "0.9"}, {"delay", "4"}};
  ProjectiveSystem first = problem.make();
  ParameterText all = options;
  all["iterations"] = std::to_string(kMost);
  LinearJacobi jacobi(problem, metric(step_of(first, "chebyshev", all, problem.dt), "relaxation"));
  // Wang 2015, eqs. 8 to 10; at its end the solver returns the smallest change it has seen.
  const ProjectiveSystem rest = after_step(problem, "jacobi", iterations(0));
  Positions y = rest.particles.x, before = y, best;
  double omega = 1.0, smallest = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= kMost; ++k) {
    const Positions next = jacobi(y);
    const double change = jacobi.change(next, y);
    const bool best_now = change <= smallest;
    if (best_now) {
      smallest = change;
      best = next;
    }
    if (k == kDelay + 1) omega = 2.0 / (2.0 - kRho * kRho);
    if (k > kDelay + 1) omega = 4.0 / (4.0 - kRho * kRho * omega);
    const Positions accelerated = omega * (next - before) + before;
    before = y;
    y = accelerated;
    ParameterText parameters = options;
    // With fewer iterations the solver takes a smaller radius: they could not use this one.
    if (k < 12) continue;
    parameters["iterations"] = std::to_string(k);
    const ProjectiveSystem solved = after_step(problem, "chebyshev", parameters);
    const Positions& expected = best_now ? y : best;
    ASSERT_LE((solved.particles.x - expected).cwiseAbs().maxCoeff(), 1e-13 * k) << k;
  }
}

TEST(Chebyshev, IsJacobiUntilItsDelay) {
  for (const StepProblem& problem : step_problems()) {
    for (const int count : {0, 1, 5}) {
      const ProjectiveSystem plain = after_step(problem, "jacobi", iterations(count));
      const ProjectiveSystem delayed = after_step(problem, "chebyshev", iterations(count));
      EXPECT_EQ(plain.particles.x, delayed.particles.x) << problem.name << " " << count;
    }
  }
}

TEST(Chebyshev, EstimatesTheRadiusOfALinearProblemFromBelow) {
  const StepProblem problem = linear_problem();
  ProjectiveSystem system = problem.make();
  const auto solver = make_solver("chebyshev", iterations(2000));
  solver->prepare(system, problem.dt);
  const ProjectiveSystem start = problem.make();
  const StepReport report = step_of(system, *solver, problem.dt);
  const double exact = LinearJacobi(problem, metric(report, "relaxation")).radius();
  const double first = metric(report, "spectral_radius");
  EXPECT_LT(first, exact + 1e-9);
  EXPECT_GT(first, 0.5);
  // Steps from the same state teach it more.
  double last = first;
  for (int k = 0; k < 5; ++k) {
    system.particles = start.particles;
    const double now = metric(step_of(system, *solver, problem.dt), "spectral_radius");
    EXPECT_GE(now, last);
    last = now;
  }
  EXPECT_LT(last, exact + 1e-9);
}

TEST(Chebyshev, ForcedRadiusIsKeptWhereTheIterationsCanUseIt) {
  const StepProblem problem = linear_problem();
  const auto used = [&](const char* rho, int count) {
    ProjectiveSystem system = problem.make();
    const ParameterText parameters{{"spectral_radius", rho}, {"iterations", std::to_string(count)}};
    return metric(step_of(system, "chebyshev", parameters, problem.dt), "spectral_radius");
  };
  EXPECT_EQ(used("0.7", 200), 0.7);
  // Ten iterations with 0.99999 would leave 99.95 % of every error component.
  EXPECT_LT(used("0.99999", 15), 0.96);
  // T_n(1/rho) = 10 for the n that are left after the delay.
  EXPECT_NEAR(std::cosh(10 * std::acosh(1.0 / used("0.99999", 15))), 10.0, 1e-9);
}

TEST(Chebyshev, NeverAssumesMoreThanInertiaAllows) {
  // No eigenvalue of D^-1 A is below the smallest share of inertia in D.
  const StepProblem problem = step_problems().front();
  ProjectiveSystem system = problem.make();
  const ParameterText forced{{"spectral_radius", "0.99999"}, {"iterations", "10000"}};
  const StepReport report = step_of(system, "chebyshev", forced, problem.dt);
  const Eigen::VectorXd inertia = system.particles.mass / (problem.dt * problem.dt);
  const double least =
      inertia.cwiseQuotient(dense_matrix(system, problem.dt).diagonal()).minCoeff();
  const double gamma = metric(report, "relaxation");
  EXPECT_LE(metric(report, "spectral_radius"), std::max(1.0 - gamma * least, 0.8));
}

TEST(Chebyshev, ABodyInFreeFallTeachesNothing) {
  ClothScene scene;
  scene.solver = "chebyshev";
  scene.effects = {{"gravity", {}}, {"contact", {}}};
  scene.pose = at(0, 0, 0.02);
  scene.obstacles = {obstacle(Sphere(0.05), at(0, 0, -0.05))};
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(metric(body_of(*world).report, "spectral_radius"), 0.0);
  run_for(*world, 0.2);
  EXPECT_GT(metric(body_of(*world).report, "spectral_radius"), 0.5);
}

/// A cube that is held at one side and twisted.
ProjectiveSystem twisted_cube(int cells) {
  BlockOptions options;
  options.cells.setConstant(cells);
  const TetrahedralMesh mesh = make_block(options);
  ProjectiveSystem system;
  system.particles = Particles(mesh.vertices, 1000.0 * vertex_volumes(mesh));
  system.elements.push_back(
      std::make_unique<TetrahedronSet>(mesh, lame_parameters({1e5, 0.3, 1000.0})));
  Particles& particles = system.particles;
  for (int i = 0; i < particles.size(); ++i) {
    const Eigen::Vector3d x = particles.x.col(i);
    if (x[0] < -0.499) particles.fix(i);
    particles.v.col(i) = 2.0 * (x[0] + 0.5) * Eigen::Vector3d(0.5, x[2], -x[1]);
  }
  system.external_forces = Forces::Zero(3, particles.size());
  return system;
}

// Plain iterations decay for long as if the radius were smaller: without a rehearsal each step
// would raise it again, and steps of few iterations would never learn it.
TEST(Chebyshev, RehearsesSoThatNoStepHasToRaiseTheRadius) {
  constexpr double kStep = 1.0 / 60.0;
  std::vector<double> radii;
  for (int count : {40, 60, 100}) {
    ProjectiveSystem system = twisted_cube(12);
    const StepReport report = step_of(system, "chebyshev", iterations(count), kStep);
    EXPECT_EQ(metric(report, "restarts"), 0.0) << count << " iterations";
    radii.push_back(metric(report, "spectral_radius"));
  }
  EXPECT_EQ(radii[0], radii[1]);
  EXPECT_EQ(radii[1], radii[2]);
}

TEST(Chebyshev, EstimatesAnewWhenTheStepOrTheSystemChanges) {
  const StepProblem problem = step_problems()[1];
  ProjectiveSystem system = problem.make();
  const auto solver = make_solver("chebyshev", iterations(60));
  const auto radius = [&](double dt) {
    system.particles = problem.make().particles;
    solver->prepare(system, dt);
    return metric(step_of(system, *solver, dt), "spectral_radius");
  };
  const double fine = radius(1e-3), coarse = radius(2e-2);
  EXPECT_LT(fine, coarse);
  EXPECT_EQ(radius(1e-3), fine);
}

TEST(Chebyshev, RefusesARadiusOfOne) {
  EXPECT_THROW(make_solver("chebyshev", {{"spectral_radius", "1"}}), InputError);
  EXPECT_THROW(make_solver("chebyshev", {{"spectral_radius", "-0.1"}}), InputError);
  EXPECT_THROW(make_solver("chebyshev", {{"delay", "0"}}), InputError);
}

}  // namespace
}  // namespace pliant
