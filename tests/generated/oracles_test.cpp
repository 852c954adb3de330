// Each oracle finds what it is for: runs of a good scene, with one thing made wrong.
#include <gtest/gtest.h>

#include "generated/robot.h"
#include "pliant/study/generated/generated_oracles.h"

namespace pliant::oracles_test {
namespace {

/// A cloth at rest, without gravity: all oracles look at it.
const SceneRuns& good_runs() {
  static const SceneRuns runs = run_all(SceneChoice{}, finger_path(), SceneCare::kThorough);
  return runs;
}

struct Fault {
  std::string oracle;
  void (*make)(SceneRuns&);
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.oracle; }

class Oracles : public testing::TestWithParam<Fault> {};
INSTANTIATE_TEST_SUITE_P(
    Faults, Oracles,
    testing::Values(
        Fault{"finite", [](SceneRuns& runs) { runs.here.is_finite = false; }},
        Fault{"reason", [](SceneRuns& runs) { runs.here.refusal = "?"; }},
        Fault{"time", [](SceneRuns& runs) { runs.here.seconds = 2.0 * kSceneSeconds; }},
        Fault{"same_bytes", [](SceneRuns& runs) { ++runs.again[1].hash; }},
        Fault{"rest", [](SceneRuns& runs) { runs.here.travel = 1e-9; }},
        Fault{"momentum", [](SceneRuns& runs) { runs.here.momentum_missing = 1e-9; }},
        Fault{"energy", [](SceneRuns& runs) { runs.here.energy_gained = 1e-9; }},
        Fault{"passing", [](SceneRuns& runs) { runs.here.depth = 0.01; }},
        Fault{"turned", [](SceneRuns& runs) { runs.turned.points(1, 0) += 1e-7; }},
        Fault{"rescaled", [](SceneRuns& runs) { runs.rescaled.points(1, 0) += 1e-7; }},
        Fault{"bystander", [](SceneRuns& runs) { runs.with_bystander.state[5] += 1e-17; }},
        Fault{"mirrored", [](SceneRuns& runs) { runs.mirrored.points(1, 0) += 1e-7; }},
        Fault{"step_to_zero", [](SceneRuns& runs) { runs.resolved[2].points(1, 0) += 1e-7; }},
        Fault{"told_error", [](SceneRuns& runs) { runs.here.is_inaccurate = true; }}),
    [](const auto& info) { return info.param.oracle; });

TEST_P(Oracles, FindsItsFault) {
  const SceneOutcome good = judge(SceneChoice{}, good_runs());
  EXPECT_EQ(good.fate, SceneFate::kStable) << good.oracle << ": " << good.message;
  SceneRuns bad = good_runs();
  GetParam().make(bad);
  const SceneOutcome outcome = judge(SceneChoice{}, bad);
  EXPECT_EQ(outcome.fate, SceneFate::kFailed);
  EXPECT_EQ(outcome.oracle, GetParam().oracle) << outcome.message;
  EXPECT_FALSE(outcome.message.empty());
}

}  // namespace
}  // namespace pliant::oracles_test
