#include "pliant/study/accuracy/accuracy_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/models/solver_registry.h"
#include "pliant/solvers/registry.h"
#include "pliant/study/accuracy/reference_solvers.h"
#include "pliant/study/experiments/explicit_steps.h"
#include "pliant/study/step_study.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"
#include "unit/study/study_scenes.h"

namespace pliant {
namespace {

class AccuracyPlanTest : public ::testing::Test {
 protected:
  AccuracyPlanTest() : scene_(read_scene(files_.write("scene.yaml", kSmallScene))) {}
  AccuracyPlan plan(const AccuracyOptions& options) { return make_accuracy_plan(scene_, options); }
  void refused(const AccuracyOptions& options, const std::vector<std::string>& parts) {
    expect_refusal([&] { plan(options); }, parts);
  }

  SceneFiles files_;
  SceneSpec scene_;
};

TEST_F(AccuracyPlanTest, HasARowForEachSolverAndCount) {
  const AccuracyPlan small = plan(small_study());
  ASSERT_EQ(small.rows.size(), 6u);
  EXPECT_EQ(small.rows[4].solver.name, "jacobi");
  EXPECT_EQ(small.rows[4].solver.parameters, (ParameterText{{"iterations", "8"}}));
  EXPECT_EQ(small.rows[4].measure, Measure::kStep);
  EXPECT_EQ(small.rows[4].time_step, 0.005);
  EXPECT_EQ(small.steps, 6);
  EXPECT_DOUBLE_EQ(small.duration, 0.03);
}

TEST_F(AccuracyPlanTest, TakesEverySolverOfTheRegistryThatIterates) {
  AccuracyOptions options = small_study();
  options.solvers.clear();
  const AccuracyPlan all = plan(options);
  EXPECT_EQ(all.options.solvers, solver_registry().names_for("cloth"));
  for (const std::string& name : all.options.solvers) {
    const auto rows = std::count_if(all.rows.begin(), all.rows.end(),
                                    [&](const PlannedRow& row) { return row.solver.name == name; });
    EXPECT_EQ(rows, takes_iterations(name) ? 3 : 0) << name;
  }
  ASSERT_EQ(all.notes.size(), 1u);
  EXPECT_NE(all.notes[0].find("verlet is explicit"), std::string::npos);
}

TEST_F(AccuracyPlanTest, ADurationIsOneSecondUnlessSaid) {
  AccuracyOptions options = small_study();
  options.steps.reset();
  EXPECT_EQ(plan(options).steps, 200);
  options.duration = 0.05;
  EXPECT_EQ(plan(options).steps, 10);
}

TEST_F(AccuracyPlanTest, KeepsTheSceneSolversOwnParameters) {
  scene_.solver = {"verlet", {{"contact_sweeps", "3"}}, "test"};
  EXPECT_EQ(solver_setting(scene_, "verlet", 8).parameters,
            (ParameterText{{"contact_sweeps", "3"}}));
  scene_.solver = {"xpbd", {{"iterations", "20"}, {"tolerance", "0.1"}, {"budget", "3"}}, "test"};
  EXPECT_EQ(solver_setting(scene_, "xpbd", 8).parameters, (ParameterText{{"iterations", "8"}}));
  EXPECT_EQ(solver_setting(scene_, "jacobi", 8).parameters, (ParameterText{{"iterations", "8"}}));
}

TEST_F(AccuracyPlanTest, RunsTakeTheListedStepsAndExplicitSolversStableOnes) {
  AccuracyOptions options = small_study();
  options.solvers = {"jacobi", "verlet"};
  options.iterations = {4};
  options.time_steps = {0.01, 0.005};
  const AccuracyPlan runs = plan(options);
  EXPECT_DOUBLE_EQ(runs.reference_time_step, 0.00125);
  std::vector<double> steps;
  for (const PlannedRow& row : runs.rows) {
    if (row.solver.name == "verlet") steps.push_back(row.time_step);
  }
  ASSERT_GE(steps.size(), 2u);
  EXPECT_EQ(steps.back(), 0.5 * steps[steps.size() - 2]);
  for (double step : steps) {
    const double halvings = std::log2(0.01 / step);
    EXPECT_NEAR(halvings, std::round(halvings), 1e-9);
  }
}

TEST_F(AccuracyPlanTest, ExplicitStepsAreHalvedUntilStable) {
  const SolverSetting verlet = solver_setting(scene_, "verlet", 0);
  const std::vector<double> coarse = explicit_time_steps(scene_, verlet, {0.32, 0.16});
  ASSERT_EQ(coarse.size(), 2u);  // both end at the same step
  EXPECT_LT(coarse[0], 0.16);
  const std::vector<double> fine = explicit_time_steps(scene_, verlet, {1e-4});
  EXPECT_EQ(fine, (std::vector<double>{1e-4, 5e-5}));
}

TEST_F(AccuracyPlanTest, RefusesSolversThatDoNotFit) {
  AccuracyOptions options = small_study();
  options.solvers = {"xpdb"};
  refused(options, {"unknown solver 'xpdb'", "did you mean 'xpbd'?"});
  options.solvers = {"verlet"};
  refused(options, {"none of the solvers takes iterations", "--dt"});
}

TEST_F(AccuracyPlanTest, RefusesReferencesThatDoNotConverge) {
  AccuracyOptions options = small_study();
  options.references = {"verlet"};
  refused(options, {"--references: verlet takes no iterations"});
  options.references = {"xpbd", "xpbd"};
  refused(options, {"--references has xpbd twice"});
  options.references = {"xpbd", "jacobi", "xpbd"};
  refused(options, {"--references names 3"});
  options.references = {"newtn"};
  refused(options, {"unknown solver 'newtn'"});
  expect_refusal(
      [] {
        choose_references({"jacobi", "verlet"}, {});
      },
      {"two solvers that converge", "[jacobi]"});
}

TEST(References, AreTheMostExactOnes) {
  EXPECT_EQ(choose_references({"xpbd", "jacobi"}, {}),
            (std::vector<std::string>{"jacobi", "xpbd"}));
  EXPECT_EQ(choose_references({"verlet", "xpbd", "jacobi"}, {"xpbd"}),
            (std::vector<std::string>{"xpbd", "jacobi"}));
  EXPECT_EQ(choose_references(solver_registry().names(), {}),
            (std::vector<std::string>{"newton", "lbfgs"}));
}

TEST_F(AccuracyPlanTest, ReferencesTakeNoMoreIterationsThanTheyMay) {
  EXPECT_EQ(choose_references({"trigonometric", "imex_thesis", "newmark", "midpoint"}, {}),
            (std::vector<std::string>{"newmark", "midpoint"}));
  for (const std::string& name : all_solvers().names()) {
    if (!takes_iterations(name)) continue;
    const SolverSetting setting = reference_setting(scene_, name, 1e-9);
    EXPECT_EQ(std::to_string(setting.iterations), setting.parameters.at("iterations"));
    for (const ParameterSpec& spec : all_solvers().find(name).parameters) {
      if (spec.name != "iterations") continue;
      EXPECT_LE(setting.iterations, spec.max) << name;
    }
  }
}

TEST_F(AccuracyPlanTest, IntegratorsOfReducedBodiesHaveTheirOwn) {
  for (const char* name : {"newmark", "midpoint", "trigonometric", "verlet"}) {
    EXPECT_EQ(integration_name(scene_, {name, {}, 0}), "own") << name;
  }
  EXPECT_EQ(integration_name(scene_, {"newton", {}, 8}), "implicit_euler");
}

TEST_F(AccuracyPlanTest, RefusesBadCountsAndTimes) {
  AccuracyOptions options = small_study();
  for (double steps : {0.0, -1.0, 1.5, 2e6, std::nan("")}) {
    options.steps = steps;
    refused(options, {"--steps", "whole number from 1"});
  }
  options.duration = 1.0;
  refused(options, {"either --steps N or --duration S"});
  options.steps.reset();
  for (double duration : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    options.duration = duration;
    refused(options, {"--duration", "must be > 0"});
  }
  options.duration = 0.0123;
  refused(options, {"--duration: 0.0123 s is no whole number of steps of 0.005 s"});
  options.duration = 1e5;
  refused(options, {"--duration", "at most 1000000"});
}

TEST_F(AccuracyPlanTest, RefusesMoreSamplesThanSteps) {
  AccuracyOptions options = small_study();
  options.samples = 7;
  refused(options, {"--samples is 7", "1 to 6", "--duration"});
  options.samples = 0;
  refused(options, {"--samples is 0"});
  options.samples = 1;
  options.repeats = 0;
  refused(options, {"--repeats is 0"});
  options.repeats = 1;
  options.iterations.clear();
  refused(options, {"--iterations is empty"});
}

TEST_F(AccuracyPlanTest, RefusesTimeStepsThatMissTheEnd) {
  AccuracyOptions options = small_study();
  options.time_steps = {0.007};
  refused(options, {"--dt: 0.03 s is no whole number of steps of 0.007 s", "0.006 s would be"});
}

TEST(SampleSteps, LieInTheMiddlesOfEqualParts) {
  EXPECT_EQ(sample_steps(10, 5), (std::vector<int>{1, 3, 5, 7, 9}));
  EXPECT_EQ(sample_steps(3, 3), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(sample_steps(100, 1), (std::vector<int>{50}));
}

}  // namespace
}  // namespace pliant
