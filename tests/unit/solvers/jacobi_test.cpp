// Jacobi iterations, plain and weighted, against their formulas.
#include "pliant/solvers/iterations/jacobi.h"

#include <gtest/gtest.h>

#include "pliant/solvers/iterations/line_search_jacobi.h"
#include "support/random.h"
#include "support/solvers/solver_systems.h"
#include "support/solvers/system_model.h"

namespace pliant {
namespace {

class JacobiOn : public testing::TestWithParam<StepProblem> {
 protected:
  /// After `count` iterations.
  ProjectiveSystem after(const std::string& solver, int count, ParameterText more = {}) const {
    more["iterations"] = std::to_string(count);
    return after_step(GetParam(), solver, more);
  }
  double dt() const { return GetParam().dt; }
};
INSTANTIATE_TEST_SUITE_P(Problems, JacobiOn, testing::ValuesIn(step_problems()), problem_name);

/// Of positions of about 0.3 m after one update.
constexpr double kJacobiRoundOff = 1e-14;

TEST_P(JacobiOn, MovesEachParticleByItsForceOverItsDiagonal) {
  for (const int count : {0, 1, 10}) {
    const ProjectiveSystem before = after("jacobi", count);
    const Relaxation relaxation =
        make_relaxation(projective_matrix(before, dt()), before.particles);
    const Positions expected =
        before.particles.x + unbalanced_after(before, dt()) * relaxation.mobility.asDiagonal();
    const ProjectiveSystem next = after("jacobi", count + 1);
    EXPECT_LE((next.particles.x - expected).cwiseAbs().maxCoeff(), kJacobiRoundOff) << count;
  }
}

TEST_P(JacobiOn, WithoutSpreadTheWeightsAreOneAndTheStepIsTheBest) {
  for (const int count : {0, 1, 10}) {
    const ProjectiveSystem before = after("line_search_jacobi", count, {{"spread", "1"}});
    const Eigen::MatrixXd a = dense_matrix(before, dt());
    const Forces r = unbalanced_after(before, dt());
    const Positions d = r * free_mobility(a.diagonal(), before.particles).asDiagonal();
    const double step = d.cwiseProduct(r).sum() / d.cwiseProduct(d * a).sum();
    const ProjectiveSystem next = after("line_search_jacobi", count + 1, {{"spread", "1"}});
    EXPECT_LE((next.particles.x - before.particles.x - step * d).cwiseAbs().maxCoeff(),
              kJacobiRoundOff);
  }
}

TEST_P(JacobiOn, AnyWeightsTakeTheBestStepAlongTheirDirection) {
  for (const char* spread : {"1", "2", "100"}) {
    const ProjectiveSystem before = after("line_search_jacobi", 3, {{"spread", spread}});
    const ProjectiveSystem next = after("line_search_jacobi", 4, {{"spread", spread}});
    const Positions displacement = next.particles.x - before.particles.x;
    const Forces r = unbalanced_after(before, dt());
    // Where the quadratic bound -r.d + 1/2 d.A d is least along d, its slope d.(r - A d) is none.
    const double work = displacement.cwiseProduct(r).sum();
    const double slope =
        work - displacement.cwiseProduct(displacement * dense_matrix(before, dt())).sum();
    EXPECT_LE(std::abs(slope), 1e-9 * work) << spread;
    EXPECT_GT(work, 0.0);
  }
}

TEST_P(JacobiOn, WeightsAreWithinTheirSpread) {
  const ProjectiveSystem before = after("line_search_jacobi", 3, {{"spread", "3"}});
  const ProjectiveSystem next = after("line_search_jacobi", 4, {{"spread", "3"}});
  const Forces r = unbalanced_after(before, dt());
  const Eigen::VectorXd diagonal = dense_matrix(before, dt()).diagonal();
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (int i = 0; i < r.cols(); ++i) {
    if (before.particles.is_fixed(i)) continue;
    const double plain = r.col(i).norm() / diagonal[i];
    if (plain < 1e-9) continue;
    const double weight = (next.particles.x.col(i) - before.particles.x.col(i)).norm() / plain;
    least = std::min(least, weight);
    most = std::max(most, weight);
  }
  EXPECT_LE(most, 9.0 * least * (1.0 + 1e-5));
  // And they are not all alike.
  EXPECT_GE(most, 1.5 * least);
}

TEST(LineSearchJacobi, IsPlainJacobiWhereThereIsContact) {
  Positions result[2];
  for (int k = 0; k < 2; ++k) {
    ClothScene scene;
    scene.solver = k == 0 ? "jacobi" : "line_search_jacobi";
    scene.solver_parameters = iterations(20);
    scene.pose = at(0, 0, 0.0012);
    scene.obstacles = {obstacle(Plane())};
    scene.effects = {{"gravity", {}}, {"contact", {}}};
    auto world = make_world(scene);
    for (int step = 0; step < 20; ++step) ASSERT_TRUE(world->step());
    result[k] = particles_of(*world).x;
  }
  EXPECT_EQ(result[0], result[1]);
}

/// Momentum and angular momentum that a body bent at rest has after one step of two iterations,
/// over what its particles have among themselves.
Eigen::Vector2d momentum_from_rest() {
  Random random(6);
  const Positions x = random.positions(12, 1.0);
  auto model = std::make_unique<SystemModel>(x, Eigen::VectorXd::LinSpaced(12, 0.1, 0.4));
  std::vector<Spring> springs;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < i; ++j) springs.push_back({j, i, (x.col(i) - x.col(j)).norm(), 50.0});
  }
  model->add("stretch", springs);
  auto world = world_of(std::move(model), 0.05, "line_search_jacobi", {{"iterations", "2"}});
  Particles& p = world->bodies().front().particles();
  p.x += random.positions(12, 0.3);
  EXPECT_TRUE(world->step());
  Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  double size = 0.0;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d momentum = p.mass[i] * p.v.col(i);
    linear += momentum;
    angular += p.x.col(i).cross(momentum);
    size += momentum.norm();
  }
  return Eigen::Vector2d(linear.norm(), angular.norm()) / size;
}

TEST(LineSearchJacobi, KeepsMomentum) {
  // Positions round to 1e-16 of a metre, of moves of a few centimetres.
  EXPECT_LT(momentum_from_rest().maxCoeff(), 1e-13);
}

TEST(LineSearchJacobi, RefusesASpreadBelowOne) {
  EXPECT_THROW(make_solver("line_search_jacobi", {{"spread", "0.5"}}), InputError);
}

}  // namespace
}  // namespace pliant
