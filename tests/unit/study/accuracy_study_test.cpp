#include "pliant/study/accuracy/accuracy_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/study/run_study.h"
#include "pliant/study/step_study.h"
#include "unit/scene/scene_files.h"
#include "unit/study/study_scenes.h"

namespace pliant {
namespace {

/// The table without what the clock says.
std::string without_times(std::vector<AccuracyRow> rows) {
  for (AccuracyRow& row : rows) {
    for (double AccuracyRow::*seconds :
         {&AccuracyRow::step_seconds, &AccuracyRow::longest_seconds,
          &AccuracyRow::seconds_per_second, &AccuracyRow::wall_seconds,
          &AccuracyRow::prepare_seconds}) {
      EXPECT_GT(row.*seconds, 0.0);
      row.*seconds = 0.0;
    }
  }
  return to_csv(rows);
}

class AccuracyStudyTest : public ::testing::Test {
 protected:
  SceneSpec scene(const std::string& text) { return read_scene(files_.write("scene.yaml", text)); }
  AccuracyOptions both_measures() {
    AccuracyOptions options = small_study();
    options.time_steps = {0.005};
    return options;
  }
  std::vector<AccuracyRow> rows_of(const AccuracyPlan& plan) {
    StudyFolder folder;
    EXPECT_TRUE(run_accuracy_study(plan, folder, nullptr).is_done());
    return folder.rows();
  }
  SceneFiles files_;
};

TEST_F(AccuracyStudyTest, IsTheSameTwice) {
  for (const char* text : {kSmallScene, kContactScene}) {
    const AccuracyPlan plan = make_accuracy_plan(scene(text), both_measures());
    const auto rows = rows_of(plan);
    ASSERT_EQ(rows.size(), plan.rows.size());
    EXPECT_EQ(without_times(rows), without_times(rows_of(plan)));
  }
}

TEST_F(AccuracyStudyTest, ResumedEqualsUninterruptedAtEveryPlace) {
  const AccuracyPlan plan = make_accuracy_plan(scene(kContactScene), both_measures());
  const std::string whole = without_times(rows_of(plan));
  for (int calls = 1; calls < 400; calls += 97) {
    StudyFolder folder;
    int left = calls, sittings = 0;
    StudyStatus status = StudyStatus::interrupted();
    while (!status.is_done() && ++sittings < 100) {
      status = run_accuracy_study(plan, folder,
                                  [&](double, double, const std::string&) { return --left != 0; });
      EXPECT_NE(status.end, StudyStatus::End::kNotFinite);
      left = calls + 50 * sittings;  // else the references would never be done
    }
    EXPECT_EQ(without_times(folder.rows()), whole) << calls;
  }
}

TEST_F(AccuracyStudyTest, MoreIterationsAreBetterAndTheReferenceIsExact) {
  const AccuracyPlan plan = make_accuracy_plan(scene(kSmallScene), small_study());
  const auto rows = rows_of(plan);
  for (std::size_t k = 3; k < 6; ++k) {
    EXPECT_EQ(rows[k].solver, "jacobi");
    EXPECT_LT(rows[k].error, k > 3 ? rows[k - 1].error : 2.0);
    EXPECT_EQ(rows[k].used_iterations, rows[k].iterations);
    EXPECT_LE(rows[k].median_error, rows[k].error);
    EXPECT_GE(rows[k].largest, rows[k].rms);
  }
  AccuracyOptions fine = small_study();
  fine.solvers = {"jacobi"};
  fine.iterations = {5000};
  EXPECT_LT(rows_of(make_accuracy_plan(scene(kSmallScene), fine))[0].error, 1e-6);
}

TEST_F(AccuracyStudyTest, ConvergedSolversAgreeInContactWithFriction) {
  AccuracyOptions options = small_study();
  options.solvers = {"jacobi"};
  options.iterations = {1000};
  options.steps = 40;
  options.samples = 5;
  const auto rows = rows_of(make_accuracy_plan(scene(kContactScene), options));
  EXPECT_EQ(rows[0].states, 5);
  EXPECT_LT(rows[0].disagreement, 1e-8);
  EXPECT_LT(rows[0].error, 1e-8);
}

TEST_F(AccuracyStudyTest, LeavesOutStatesOnWhichTheReferencesDisagree) {
  // xpbd does not converge to the implicit step, but for a body that strains little.
  AccuracyOptions options = small_study();
  options.solvers = {"jacobi"};
  options.iterations = {1000};
  options.references = {"newton", "xpbd"};
  options.steps = 10;
  options.samples = 10;
  const auto early = rows_of(make_accuracy_plan(scene(kContactScene), options));
  EXPECT_GE(early[0].states, 5);
  EXPECT_LT(early[0].states, 10);
  EXPECT_LE(early[0].disagreement, kGoodAgreement);
  options.steps = 40;  // now they disagree on most
  const auto late = rows_of(make_accuracy_plan(scene(kContactScene), options));
  EXPECT_EQ(late[0].states, 10);
  EXPECT_GT(late[0].disagreement, kGoodAgreement);
}

TEST_F(AccuracyStudyTest, WhatEndsByItselfIsMeasuredOnce) {
  AccuracyOptions options = small_study();
  options.solvers = {"newton"};
  options.iterations = {1, 50, 100};
  const auto rows = rows_of(make_accuracy_plan(scene(kSmallScene), options));
  EXPECT_FALSE(rows[0].is_converged());
  EXPECT_TRUE(rows[1].is_converged());
  EXPECT_EQ(rows[2].iterations, 100);
  EXPECT_EQ(rows[2].step_seconds, rows[1].step_seconds);
  EXPECT_EQ(rows[2].error, rows[1].error);
}

TEST_F(AccuracyStudyTest, NoSolverAtAllIsAnErrorOfAboutOne) {
  AccuracyOptions options = small_study();
  options.solvers = {"jacobi"};
  options.iterations = {1};
  const double error = rows_of(make_accuracy_plan(scene(kSmallScene), options))[0].error;
  EXPECT_GT(error, 0.1);
  EXPECT_LT(error, 1.2);
}

TEST_F(AccuracyStudyTest, SamplesAreTheStatesOfTheReferenceRun) {
  // The converged step of the last sample is the reference's own next step: the first iterate of a
  // solver that has converged already moves nothing.
  AccuracyOptions options = small_study();
  options.samples = 1;
  options.steps = 1;
  const AccuracyPlan one = make_accuracy_plan(scene(kSmallScene), options);
  StepStudy study(one);
  WorkMeter work(nullptr);
  ASSERT_TRUE(study.prepare(work).is_done());
  const auto first = study.measure(one.rows[4], work);
  const auto again = study.measure(one.rows[4], work);
  ASSERT_TRUE(first && again);
  EXPECT_EQ(without_times({*first}), without_times({*again}));
}

TEST_F(AccuracyStudyTest, RunErrorsFallWithTheTimeStep) {
  AccuracyOptions options = small_study();
  options.solvers = {"jacobi", "verlet"};
  options.iterations = {300};
  options.steps = 40;
  options.time_steps = {0.02, 0.01, 0.005};
  const AccuracyPlan plan = make_accuracy_plan(scene(kSmallScene), options);
  const auto rows = rows_of(plan);
  std::vector<double> errors;
  for (const AccuracyRow& row : rows) {
    if (row.measure == Measure::kRun && row.solver == "jacobi") errors.push_back(row.error);
  }
  ASSERT_EQ(errors.size(), 3u);
  // Of first order: half the step, half the error.
  EXPECT_NEAR(errors[0] / errors[1], 2.0, 0.5);
  EXPECT_NEAR(errors[1] / errors[2], 2.0, 0.5);
  // The explicit solver's last row has half the step of the one before.
  EXPECT_EQ(rows.back().solver, "verlet");
  EXPECT_LT(rows.back().error, 0.6 * rows[rows.size() - 2].error);
}

TEST_F(AccuracyStudyTest, WhatBlowsUpIsARowWithInfiniteErrors) {
  AccuracyOptions options = both_measures();
  options.solvers = {"verlet"};
  options.steps = 120;
  AccuracyPlan plan = make_accuracy_plan(scene(kSmallScene), options);
  plan.rows.resize(1);
  plan.rows[0].time_step = 0.05;
  plan.rows[0].solver.parameters["max_substeps"] = "1";
  StudyFolder folder;
  ASSERT_TRUE(run_accuracy_study(plan, folder, nullptr).is_done());
  EXPECT_FALSE(folder.rows()[0].is_finite);
  EXPECT_TRUE(std::isinf(folder.rows()[0].error));
}

TEST_F(AccuracyStudyTest, SaysWhenTheReferenceIsNotFinite) {
  AccuracyPlan plan = make_accuracy_plan(scene(kSmallScene), small_study());
  plan.scene.limits.max_speed = 1e-3;
  StudyFolder folder;
  const StudyStatus status = run_accuracy_study(plan, folder, nullptr);
  EXPECT_EQ(status.end, StudyStatus::End::kNotFinite);
  EXPECT_NE(status.message.find("body 'cloth'"), std::string::npos) << status.message;
  EXPECT_TRUE(folder.rows().empty());
}

TEST_F(AccuracyStudyTest, ProgressEndsAtTheWorkThatWasExpected) {
  const AccuracyPlan plan = make_accuracy_plan(scene(kSmallScene), both_measures());
  StudyFolder folder;
  double last = 0.0, expected = 0.0;
  run_accuracy_study(plan, folder, [&](double done, double total, const std::string& what) {
    EXPECT_GE(done, last);
    EXPECT_FALSE(what.empty());
    last = done;
    expected = total;
    return true;
  });
  EXPECT_GT(last, 0.9 * expected);
  EXPECT_LE(last, expected * (1.0 + 1e-12));
}

}  // namespace
}  // namespace pliant
