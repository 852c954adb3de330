#include "pliant/study/experiments/reduced_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

const StudyBody& beam() {
  static const StudyBody body = make_study_body("beam", 0.02);
  return body;
}

ReducedRunOptions options_of(const std::string& integrator) {
  ReducedRunOptions options;
  options.integrator = {integrator, integrator, {}};
  options.force = beam().amplitudes[1];
  options.duration = 2.0;
  return options;
}

TEST(ReducedRun, LoadsAreTheThesiss) {
  EXPECT_EQ(load_at(ReducedLoad::kImpulse, 0.0015), 1.0);
  EXPECT_EQ(load_at(ReducedLoad::kImpulse, 0.0045), 0.0);
  EXPECT_EQ(load_at(ReducedLoad::kConstant, 0.299), 1.0);
  EXPECT_EQ(load_at(ReducedLoad::kConstant, 0.301), 0.0);
  EXPECT_NEAR(load_at(ReducedLoad::kSine, 0.25), 1.0, 1e-15);
}

TEST(ReducedRun, TheCalibratedForceGivesTheDisplacementAskedFor) {
  ReducedRunOptions options = options_of("midpoint");
  double peak = 0.0;
  const ReducedRun run = run_reduced(beam(), options, [&](const ReducedSystem& system, double) {
    peak = std::max(peak, relative_displacement(beam(), system.q));
    return true;
  });
  EXPECT_NEAR(peak, 0.02, 0.0003);
  EXPECT_FALSE(run.blew_up);
  EXPECT_NEAR(run.end, 2.0, 0.003);
  EXPECT_EQ(run.steps, 667u);
}

TEST(ReducedRun, TheThesissSplitPutsTheBeamsCoordinatesWhereItsTableSays) {
  EXPECT_EQ(beam().high, 9);
  EXPECT_EQ(beam().model.rank(), 15);
}

TEST(ReducedRun, FindsTheExplicitLimitOfTheThesissSplit) {
  // Its explicit coordinates reach f = 249 Hz, where h ω = 4.7 > 2 = h π 2 · 106 Hz.
  const Eigen::VectorXd& lambda = beam().model.potential.lambda();
  EXPECT_GT(kThesisStep * std::sqrt(lambda[beam().high - 1]), 2.0);
  const ReducedRun thesis = run_reduced(beam(), options_of("imex_thesis"));
  EXPECT_TRUE(thesis.blew_up);
  EXPECT_LT(thesis.end, 2.0);
  // With explicit coordinates below h ω = 1 the same method goes on.
  ReducedRunOptions options = options_of("imex_thesis");
  options.integrator.parameters = {{"split", "0.159"}};
  EXPECT_FALSE(run_reduced(beam(), options).blew_up);
  EXPECT_FALSE(run_reduced(beam(), options_of("trigonometric")).blew_up);
}

TEST(ReducedRun, AWatchEndsIt) {
  const ReducedRun run = run_reduced(beam(), options_of("trigonometric"),
                                     [](const ReducedSystem&, double time) { return time < 0.3; });
  EXPECT_NEAR(run.end, 0.3, 0.004);
}

TEST(ReducedRun, IsTheSameEveryTime) {
  const ReducedRun first = run_reduced(beam(), options_of("trigonometric"));
  const ReducedRun second = run_reduced(beam(), options_of("trigonometric"));
  EXPECT_EQ(first.q, second.q);
  EXPECT_EQ(first.p, second.p);
}

}  // namespace
}  // namespace pliant
