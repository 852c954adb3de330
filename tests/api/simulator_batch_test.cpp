#include "pliant/simulator_batch.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

const std::string kScene = std::string(PLIANT_SOURCE_DIR) + "/examples/library/tray.yaml";
const std::string kDensity = "bodies[jelly].material.density";

SimulatorOptions few_iterations() {
  SimulatorOptions options;
  options.solver = "jacobi";
  options.solver_parameters = {{"iterations", "5"}};
  return options;
}

TEST(SimulatorBatch, EachDoesWhatItDoesAlone) {
  SimulatorBatch batch(kScene, {{{kDensity, "800"}}, {}}, few_iterations());
  batch.step(10);
  for (int s = 0; s < batch.size(); ++s) {
    SimulatorOptions options = few_iterations();
    if (s == 0) options.values[kDensity] = "800";
    Simulator alone(kScene, options);
    alone.step(10);
    EXPECT_EQ(batch.at(s).positions("jelly"), alone.positions("jelly"));
  }
  std::vector<double> numbers(2 * static_cast<std::size_t>(batch.at(0).positions("jelly").size()));
  batch.positions("jelly", numbers.data());
  EXPECT_EQ(numbers.back(), batch.at(1).positions("jelly")(2, Eigen::last));
  batch.velocities("jelly", numbers.data());
  EXPECT_EQ(numbers.front(), batch.at(0).velocities("jelly")(0, 0));
}

TEST(SimulatorBatch, MovesTheJointsOfAll) {
  SimulatorBatch batch(kScene, {{}, {}}, few_iterations());
  batch.set_joint_positions(Eigen::Vector2d(0.0, 0.001));
  batch.step();
  EXPECT_EQ(batch.at(0).joint_positions(), std::vector<double>{0.0});
  EXPECT_EQ(batch.at(1).joint_positions(), std::vector<double>{0.001});
  expect_refusal([&] { batch.set_joint_positions(Eigen::Vector2d(0.1, 0.7)); },
                 {"joint 'height' is 0.7"});
  expect_refusal([&] { batch.set_joint_positions(Eigen::Vector3d(0, 0, 0)); },
                 {"3 rows and 1 columns", "2 simulators and 1 joints"});
  batch.step();
  EXPECT_EQ(batch.at(0).joint_positions(), std::vector<double>{0.0});
}

TEST(SimulatorBatch, OneThatStopsStopsNoOther) {
  SimulatorBatch batch(kScene, {{{"limits.max_speed", "0.01"}}, {}}, few_iterations());
  batch.step(5);
  EXPECT_NE(batch.failure(0).find("vertex"), std::string::npos) << batch.failure(0);
  EXPECT_EQ(batch.failure(1), "");
  EXPECT_LT(batch.at(0).time(), batch.at(1).time());
  batch.reset(0);
  EXPECT_EQ(batch.failure(0), "");
  EXPECT_EQ(batch.at(0).time(), 0.0);
}

TEST(SimulatorBatch, RefusesWhatThereIsNot) {
  expect_refusal([] { SimulatorBatch(kScene, {}); }, {"'rows' is empty"});
  expect_refusal([] { SimulatorBatch(kScene, {{}, {{kDensity, "-1"}}}); }, {"density", "'-1'"});
  SimulatorBatch batch(kScene, {{}}, few_iterations());
  expect_refusal([&] { batch.at(1); }, {"simulator 1", "0 to 0"});
  expect_refusal([&] { batch.failure(-1); }, {"simulator -1"});
  expect_refusal([&] { batch.step(-1); }, {"count is -1"});
}

}  // namespace
}  // namespace pliant
