// The three stopping rules, for every solver that iterates.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pliant/solvers/iterations/projective_solver.h"
#include "support/expect_refusal.h"
#include "support/measures.h"

namespace pliant {
namespace {

class IterativeSolver : public EverySolver {
 protected:
  std::unique_ptr<World> world(const ParameterText& stop) const {
    ClothScene scene;
    scene.solver = solver();
    // Newton has a tolerance of its own.
    scene.solver_parameters = {{"tolerance", "0"}};
    for (const auto& [name, value] : stop) scene.solver_parameters[name] = value;
    scene.fixed = {0, 6};
    scene.effects = {{"gravity", {}}};
    return make_world(scene);
  }
  bool corrects_at_once() const {
    return solver() == "direct" || solver() == "lbfgs" || solver() == "newton";
  }
};
PLIANT_FOR_IMPLICIT_SOLVERS(IterativeSolver);

TEST_P(IterativeSolver, StopsAfterItsIterations) {
  for (const int iterations : {0, 1, 2, 17}) {
    auto w = world({{"iterations", std::to_string(iterations)}});
    ASSERT_TRUE(w->step());
    const StepReport& report = body_of(*w).report;
    EXPECT_EQ(report.solver, solver());
    // Newton is at round-off after five iterations.
    if (report.ended_by == EndedBy::kRoundOff) {
      EXPECT_TRUE(corrects_at_once()) << solver();
      EXPECT_GE(report.iterations, 3);
      EXPECT_LE(report.iterations, iterations);
      continue;
    }
    EXPECT_EQ(report.iterations, iterations);
    EXPECT_EQ(report.ended_by, EndedBy::kIterations);
  }
}

TEST_P(IterativeSolver, StopsAtItsTolerance) {
  auto w = world({{"iterations", "100000"}, {"tolerance", "1e-3"}});
  ASSERT_TRUE(w->step());
  const StepReport& report = body_of(*w).report;
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  EXPECT_LE(report.residual, 1e-3);
  EXPECT_GT(report.residual, 0.0);
  EXPECT_GE(report.iterations, 1);
  EXPECT_LT(report.iterations, 100000);
  EXPECT_TRUE(report.warnings.empty());
}

TEST_P(IterativeSolver, DoesNotStopOneIterationLater) {
  auto w = world({{"iterations", "100000"}, {"tolerance", "1e-3"}});
  ASSERT_TRUE(w->step());
  const int needed = body_of(*w).report.iterations;
  // The residual is that at the beginning of an iteration: the last one says what was reached
  // before it.
  w = world({{"iterations", std::to_string(needed)}});
  ASSERT_TRUE(w->step());
  EXPECT_GT(body_of(*w).report.residual, 1e-3);
}

TEST_P(IterativeSolver, StopsAtItsBudget) {
  auto w = world({{"iterations", "1000000"}, {"budget", "2"}});
  ASSERT_TRUE(w->step());
  const StepReport& report = body_of(*w).report;
  if (report.ended_by == EndedBy::kRoundOff) {
    EXPECT_TRUE(corrects_at_once()) << solver();
    return;
  }
  EXPECT_EQ(report.ended_by, EndedBy::kBudget);
  EXPECT_GE(report.seconds, 2e-3);
  // The residual is that of the end, not that of the beginning.
  if (report.iterations > 100) {
    EXPECT_LT(report.residual, 0.5);
  }
}

TEST_P(IterativeSolver, ReportsAResidualThatFalls) {
  double last = 1.0;
  const bool fast = corrects_at_once();
  for (const char* iterations : {fast ? "2" : "5", fast ? "3" : "40", fast ? "4" : "320"}) {
    auto w = world({{"iterations", iterations}});
    ASSERT_TRUE(w->step());
    const double residual = body_of(*w).report.residual;
    EXPECT_TRUE(residual < last || residual == 0.0) << iterations << ": " << residual;
    last = residual;
  }
}

TEST_P(IterativeSolver, SaysWhenItDidNotConverge) {
  const auto warned = [&](const ParameterText& stop) {
    auto w = world(stop);
    EXPECT_TRUE(w->step());
    return warns(*w, "not_converged");
  };
  EXPECT_TRUE(warned({{"iterations", "1"}, {"tolerance", "1e-6"}}));
  EXPECT_FALSE(warned({{"iterations", "100000"}, {"tolerance", "1e-3"}}));
}

TEST_P(IterativeSolver, EstimatesItsErrorNowAndThen) {
  auto w = world({{"iterations", "20"}});
  std::set<std::uint64_t> estimated;
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(w->step());
    const StepReport& report = body_of(*w).report;
    ASSERT_TRUE(report.error.has_value());
    EXPECT_GE(*report.error, 0.0);
    EXPECT_LE(report.error_step, report.step);
    estimated.insert(report.error_step);
  }
  EXPECT_EQ(*estimated.begin(), 1u);
  EXPECT_GE(estimated.size(), 3u);
  EXPECT_LT(estimated.size(), 30u);
}

// Those of an explicit method are not wrong by what iterations leave.
TEST(ErrorWatch, ExplicitStepsHaveNoError) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.time_step = 1e-4;
  const auto w = make_world(scene);
  ASSERT_TRUE(w->step());
  EXPECT_FALSE(body_of(*w).report.error.has_value());
}

// A matrix would fill the memory: there the residual speaks.
TEST(ErrorWatch, LargeBodiesHaveNoneAndWarnOfTheResidual) {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 180, 180};
  scene.fixed = {0, 179};
  scene.solver = "jacobi";
  scene.solver_parameters = {{"iterations", "1"}};
  scene.effects = {{"gravity", {}}};
  const auto w = make_world(scene);
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(w->step());
  EXPECT_FALSE(body_of(*w).report.error.has_value());
  EXPECT_TRUE(warns(*w, "not_converged"));
  EXPECT_FALSE(warns(*w, "inaccurate"));
}

TEST(ErrorWatch, AnAskedErrorThatNothingEstimatesIsToldSo) {
  for (const int vertices : {7, 180}) {
    ClothScene scene;
    scene.grid = {0.3, 0.3, vertices, vertices};
    scene.fixed = {0, vertices - 1};
    scene.solver = "jacobi";
    scene.solver_parameters = {{"iterations", "1"}, {"error", "0.1"}};
    scene.effects = {{"gravity", {}}};
    const auto w = make_world(scene);
    ASSERT_TRUE(w->step());
    EXPECT_EQ(warns(*w, "error_ignored"), vertices == 180);
  }
}

// Newton goes down to a residual of the asked error then, and says where it does not come there.
TEST(ErrorWatch, NewtonWithoutAnEstimateSaysWhetherItConverges) {
  for (const char* iterations : {"1", "20"}) {
    ClothScene scene;
    scene.grid = {0.3, 0.3, 180, 180};
    scene.fixed = {0, 179};
    scene.solver = "newton";
    scene.solver_parameters = {
        {"iterations", iterations}, {"error", "0.01"}, {"linear_tolerance", "0.1"}};
    scene.effects = {{"gravity", {}}};
    const auto w = make_world(scene);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(w->step());
    EXPECT_TRUE(warns(*w, "error_ignored")) << iterations;
    EXPECT_EQ(warns(*w, "not_converged"), body_of(*w).report.residual > 0.01) << iterations;
    EXPECT_EQ(body_of(*w).report.residual <= 0.01, std::string(iterations) == "20");
  }
}

TEST(ErrorWatch, AnAskedErrorThatIsNotReachedYetIsToldSo) {
  ClothScene scene;
  scene.fixed = {0, 6};
  scene.solver = "jacobi";
  scene.effects = {{"gravity", {}}};
  for (const char* error : {"1e-9", "0.9"}) {
    scene.solver_parameters = {{"iterations", "1"}, {"error", error}};
    const auto w = make_world(scene);
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(w->step());
    EXPECT_EQ(warns(*w, "error_missed"), std::string(error) == "1e-9") << error;
  }
}

TEST(ErrorWatch, AnAskedErrorThatIsOutOfReachNamesWhatBoundsIt) {
  ClothScene scene;
  scene.fixed = {0, 6};
  scene.solver = "jacobi";
  scene.effects = {{"gravity", {}}};
  scene.solver_parameters = {{"error", "1e-9"}, {"most_iterations", "2"}};
  const auto w = make_world(scene);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(w->step());
  EXPECT_EQ(body_of(*w).report.iterations, 2);
  const auto& warnings = body_of(*w).report.warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("'most_iterations'") != std::string::npos;
  }));
}

TEST_P(IterativeSolver, RestNeedsNoIteration) {
  ClothScene scene;
  scene.solver = solver();
  scene.solver_parameters = {{"tolerance", "1e-6"}};
  auto w = make_world(scene);
  ASSERT_TRUE(w->step());
  EXPECT_EQ(body_of(*w).report.ended_by, EndedBy::kTolerance);
  EXPECT_EQ(body_of(*w).report.iterations, 0);
  EXPECT_EQ(body_of(*w).report.residual, 0.0);
}

TEST_P(IterativeSolver, RefusesBadRules) {
  expect_refusal([&] { world({{"iterations", "-1"}}); }, {"'iterations'", ">= 0"});
  expect_refusal([&] { world({{"iterations", "1.5"}}); }, {"'iterations'", "whole number"});
  expect_refusal([&] { world({{"tolerance", "2"}}); }, {"'tolerance'", "<= 1"});
  expect_refusal([&] { world({{"tolerance", "-1e-3"}}); }, {"'tolerance'", ">= 0"});
  expect_refusal([&] { world({{"error", "2"}}); }, {"'error'", "<= 1"});
  expect_refusal([&] { world({{"error", "-1e-3"}}); }, {"'error'", ">= 0"});
  expect_refusal([&] { world({{"tolerance", "nan"}}); }, {"'tolerance'"});
  expect_refusal([&] { world({{"budget", "-1"}}); }, {"'budget'", "[ms]"});
}

TEST(StopRule, ReadsItsParameters) {
  const Parameters p = parse_parameters(stop_rule_parameters("10"),
                                        {{"tolerance", "0.01"}, {"budget", "5"}}, "test");
  const StopRule rule = stop_rule(p);
  EXPECT_EQ(rule.iterations, 10);
  EXPECT_EQ(rule.tolerance, 0.01);
  EXPECT_DOUBLE_EQ(rule.budget, 0.005);
}

TEST(StopRule, MostIterationsBoundThoseOfTheFirstStepToo) {
  const auto rule = [](const ParameterText& given) {
    return stop_rule(parse_parameters(stop_rule_parameters("10"), given, "test"));
  };
  EXPECT_EQ(rule({{"error", "0.1"}, {"most_iterations", "4"}}).iterations, 4);
  EXPECT_EQ(rule({{"error", "0.1"}, {"most_iterations", "40"}}).iterations, 10);
  expect_refusal([&] { rule({{"most_iterations", "4"}}); }, {"'most_iterations'", "'error'"});
  expect_refusal(
      [&] {
        rule({{"error", "0.1"}, {"most_iterations", "0"}});
      },
      {"'most_iterations'", ">= 1"});
}

TEST(StopRule, NewtonConvergesUnlessToldOtherwise) {
  ClothScene scene;
  scene.solver = "newton";
  scene.fixed = {0, 6};
  scene.effects = {{"gravity", {}}};
  auto world = make_world(scene);
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body_of(*world).report.ended_by, EndedBy::kTolerance);
    EXPECT_LE(body_of(*world).report.residual, 1e-10);
  }
}

}  // namespace
}  // namespace pliant
