// Momentum and angular momentum of a free body in one step of implicit Euler: as far as a solver
// converged, and by how much it may be off where it did not.
#include <gtest/gtest.h>

#include "support/random.h"
#include "support/solvers/solver_systems.h"

namespace pliant::convergence_momentum_test {
namespace {

std::vector<StepProblem> free_bodies() {
  return {{"springs", [] { return spring_net(40, 2, 300.0, 0.9); }, 0.01},
          {"solid", [] {
             ProjectiveSystem system = solid_block({1e5, 0.3, 1000.0});
             for (int i = 0; i < system.particles.size(); ++i) system.particles.release(i);
             system.particles.v = Random(2).positions(system.particles.size(), 0.5);
             system.external_forces.setZero();
             return system;
           }}};
}

/// Change of momentum in the step [kg m/s].
Eigen::Vector3d impulse(const Particles& p) { return (p.v - p.v_start) * p.mass; }

/// Impulse's moment about the origin, with arms at the end of the step [kg m²/s].
Eigen::Vector3d moment(const Particles& p) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d x = p.x.col(i), change = p.v.col(i) - p.v_start.col(i);
    sum += p.mass[i] * x.cross(change);
  }
  return sum;
}

/// Round-off of a velocity taken from positions: some n of 1e-16 m over h.
double round_off(const Particles& p, double dt) {
  return 1e-15 * std::sqrt(p.size()) * p.x.cwiseAbs().maxCoeff() / dt * p.mass.sum();
}

class FreeBody : public testing::TestWithParam<std::tuple<StepProblem, std::string>> {
 protected:
  const StepProblem& problem() const { return std::get<0>(GetParam()); }
  const std::string& solver() const { return std::get<1>(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(
    All, FreeBody,
    testing::Combine(testing::ValuesIn(free_bodies()),
                     testing::Values("jacobi", "line_search_jacobi", "gauss_seidel", "hybrid",
                                     "chebyshev", "direct", "lbfgs", "newton")),
    [](const auto& info) { return std::get<0>(info.param).name + "_" + std::get<1>(info.param); });

TEST_P(FreeBody, ConvergedKeepsMomentum) {
  // The elastic energy knows neither place nor orientation of the body where the step ends: its
  // forces there have no sum and no moment about it. So sum m x_1 x (v_1 - v_0) = 0, which is what
  // implicit Euler keeps of angular momentum: L falls by h sum m v_0 x v_1.
  const ProjectiveSystem system =
      after_step(problem(), solver(), {{"iterations", "100000"}, {"tolerance", "1e-12"}});
  const Particles& p = system.particles;
  ASSERT_GT((p.v - p.v_start).norm(), 0.1);
  // A residual of 1e-12 times that at the prediction is at most so much of all forces together.
  const double left = 1e-12 * (p.v - p.v_start).norm() * p.mass.sum() * 10.0;
  EXPECT_LE(impulse(p).norm(), left + round_off(p, problem().dt));
  EXPECT_LE(moment(p).norm(), left + round_off(p, problem().dt));
}

TEST_P(FreeBody, OtherwiseTheResidualBoundsIt) {
  // Unbalanced forces r make an impulse of -h sum r, of which |sum r| <= sqrt(sum D) |D^-1/2 r|;
  // the moment's arms add a factor of the largest distance.
  for (const char* tolerance : {"0.3", "1e-2", "1e-4"}) {
    ProjectiveSystem system = problem().make();
    const StepReport report = step_of(
        system, solver(), {{"iterations", "100000"}, {"tolerance", tolerance}}, problem().dt);
    ASSERT_EQ(report.ended_by, EndedBy::kTolerance);
    const Eigen::VectorXd d = dense_matrix(system, problem().dt).diagonal();
    const ProjectiveSystem start = after_step(problem(), "jacobi", iterations(0));
    const double scale =
        (unbalanced_after(start, problem().dt) * d.cwiseSqrt().cwiseInverse().asDiagonal()).norm();
    const Particles& p = system.particles;
    // Chebyshev may return another state than that whose residual it measured: J of the best one,
    // whose residual is no larger than 1 + gamma lambda_max < 3 times that.
    const double factor = solver() == "chebyshev" ? 3.0 : 1.0;
    const double bound = factor * problem().dt * std::stod(tolerance) * scale * std::sqrt(d.sum());
    EXPECT_LE(impulse(p).norm(), bound + round_off(p, problem().dt)) << tolerance;
    const double arm = p.x.colwise().norm().maxCoeff();
    EXPECT_LE(moment(p).norm(), arm * bound + round_off(p, problem().dt)) << tolerance;
  }
}

TEST_P(FreeBody, AnyNumberOfIterationsKeepsIt) {
  for (const int count : {1, 3, 30}) {
    const ProjectiveSystem system = after_step(problem(), solver(), iterations(count));
    const Particles& p = system.particles;
    EXPECT_LE(impulse(p).norm(), round_off(p, problem().dt)) << count;
  }
}

}  // namespace
}  // namespace pliant::convergence_momentum_test
