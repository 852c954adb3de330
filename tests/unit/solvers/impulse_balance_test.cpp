#include "pliant/solvers/impulse_balance.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/system_model.h"

namespace pliant::impulse_balance_unit_test {
namespace {

constexpr double kDt = 0.02;

/// A heap of springs, tangled and out of balance, that moves, turns and falls.
std::unique_ptr<SystemModel> tangle(int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  constexpr int kCount = 15;
  const Positions x = random.positions(kCount, 1.0);
  auto model =
      std::make_unique<SystemModel>(x, Eigen::VectorXd::LinSpaced(kCount, 0.1, 0.5 + 0.1 * seed));
  std::vector<Spring> springs;
  for (int i = 0; i < kCount; ++i) {
    for (int j = 0; j < i; ++j) {
      springs.push_back({j, i, 1.02 * (x.col(i) - x.col(j)).norm(), random(50.0, 5e4)});
    }
  }
  model->add("stretch", springs);
  model->particles().v = random.positions(kCount, 1.0);
  return model;
}

std::vector<std::string> projective_solvers() {
  std::vector<std::string> names;
  for (const std::string& name : solver_registry().names_for("cloth")) {
    if (name != "verlet") names.push_back(name);
  }
  return names;
}

class ImpulseBalanceOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, ImpulseBalanceOf, testing::ValuesIn(projective_solvers()),
                         [](const auto& info) { return info.param; });

// Implicit Euler at convergence: Σ m (x − y) = 0 and Σ m x × (x − y) = 0, y = x₀ + h v₀.
TEST_P(ImpulseBalanceOf, OneIterationMovesAFreeBodyAsConvergedOnesDo) {
  for (int seed = 1; seed <= 5; ++seed) {
    auto world = world_of(tangle(seed), kDt, GetParam(), {{"iterations", "1"}});
    Particles& p = world->bodies().front().particles();
    for (int step = 0; step < 5; ++step) {
      const Positions y = p.x + kDt * p.v;
      ASSERT_TRUE(world->step()) << world->failure();
      Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
      double size = 0.0;
      for (int i = 0; i < p.size(); ++i) {
        const Eigen::Vector3d moved = p.mass[i] * (p.x.col(i) - y.col(i));
        shift += moved;
        turn += p.x.col(i).cross(moved);
        size += p.mass[i] * kDt * p.v_start.col(i).norm();
      }
      EXPECT_LT(shift.norm(), 1e-13 * size) << "seed " << seed << ", step " << step;
      EXPECT_LT(turn.norm(), 1e-11 * size) << "seed " << seed << ", step " << step;
      EXPECT_LT(world->bodies().front().report.impulse_imbalance, 1e-11);
    }
  }
}

TEST(ImpulseBalance, PredictsTurningBodiesWithoutStretchingThem) {
  auto model = tangle(3);
  auto& system = static_cast<ProjectiveSystem&>(model->system());
  Particles& p = system.particles;
  const Eigen::Vector3d spin(8.0, -5.0, 12.0), center = p.center_of_mass();
  for (int i = 0; i < p.size(); ++i) {
    p.v.col(i) = Eigen::Vector3d(0.3, 0.1, -0.2) + spin.cross(p.x.col(i) - center);
  }
  p.x_start = p.x;
  p.x += kDt * p.v;
  ImpulseBalance balance;
  balance.prepare(system, kDt);
  balance.turn_prediction(system);
  for (int i = 0; i < p.size(); ++i) {
    for (int j = 0; j < i; ++j) {
      const double was = (p.x_start.col(i) - p.x_start.col(j)).norm();
      EXPECT_NEAR((p.x.col(i) - p.x.col(j)).norm(), was, 1e-11);
    }
  }
  const Eigen::Vector3d moved = p.center_of_mass() - center;
  EXPECT_LT((moved - kDt * Eigen::Vector3d(0.3, 0.1, -0.2)).norm(), 1e-14);
}

TEST(ImpulseBalance, LeavesBodiesAloneThatSomethingHolds) {
  auto model = tangle(2);
  model->particles().fix(0);
  auto& system = static_cast<ProjectiveSystem&>(model->system());
  system.particles.x_start = system.particles.x;
  system.particles.v_start = system.particles.v;
  system.external_forces = Forces::Constant(3, system.particles.size(), -1.0);
  ImpulseBalance balance;
  balance.prepare(system, kDt);
  const Positions before = system.particles.x;
  balance.turn_prediction(system);
  balance.correct(system, system.particles.inverse_mass);
  EXPECT_EQ(system.particles.x, before);
  EXPECT_EQ(balance.imbalance(system), 0.0);
}

}  // namespace
}  // namespace pliant::impulse_balance_unit_test
