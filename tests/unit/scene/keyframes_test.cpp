#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/scene/robot/motion/keyframe_file.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

using Interpolation = Keyframes::Interpolation;

Keyframes make(const std::vector<double>& times, const std::vector<double>& values,
               Interpolation interpolation, bool loop = false) {
  const Eigen::MatrixXd positions =
      Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return Keyframes({"a"}, times, positions, interpolation, loop);
}

TEST(Keyframes, LinearIsLinearAndHoldsAtTheEnds) {
  const Keyframes keyframes = make({1, 2, 4}, {0, 10, 30}, Interpolation::kLinear);
  EXPECT_EQ(keyframes.position(0, -5), 0.0);
  EXPECT_EQ(keyframes.position(0, 1), 0.0);
  EXPECT_DOUBLE_EQ(keyframes.position(0, 1.5), 5.0);
  EXPECT_DOUBLE_EQ(keyframes.position(0, 3), 20.0);
  EXPECT_EQ(keyframes.position(0, 4), 30.0);
  EXPECT_EQ(keyframes.position(0, 100), 30.0);
}

TEST(Keyframes, CubicBetweenTwoIsASmoothStep) {
  const Keyframes keyframes = make({0, 2}, {1, 3}, Interpolation::kCubic);
  for (double s : {0.1, 0.25, 0.5, 0.9}) {
    EXPECT_NEAR(keyframes.position(0, 2 * s), 1 + 2 * s * s * (3 - 2 * s), 1e-14);
  }
}

TEST(Keyframes, CubicReproducesAStraightLineInside) {
  const Keyframes keyframes = make({0, 1, 2, 3, 4}, {0, 1, 2, 3, 4}, Interpolation::kCubic);
  for (double t = 1.0; t <= 3.0; t += 0.125) EXPECT_NEAR(keyframes.position(0, t), t, 1e-14);
}

TEST(Keyframes, CubicNeverOvershoots) {
  const std::vector<double> times = {0, 0.1, 0.2, 1.5, 1.6, 5, 5.00001, 6};
  const std::vector<double> values = {0, 0, 1, 1.1, 7, 7, -3, -3};
  const Keyframes keyframes = make(times, values, Interpolation::kCubic);
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    double last = values[k];
    const double sign = values[k + 1] >= values[k] ? 1.0 : -1.0;
    for (int i = 0; i <= 100; ++i) {
      const double t = times[k] + (times[k + 1] - times[k]) * i / 100.0;
      const double value = keyframes.position(0, t);
      EXPECT_GE(sign * (value - last), -1e-12) << "at " << t;
      last = value;
    }
  }
}

TEST(Keyframes, CubicStandsStillBetweenEqualOnes) {
  const Keyframes keyframes = make({0, 1, 2, 3}, {0, 5, 5, 9}, Interpolation::kCubic);
  for (double t = 1.0; t <= 2.0; t += 0.1) EXPECT_EQ(keyframes.position(0, t), 5.0);
  // The velocity is continuous: it is 0 on both sides.
  EXPECT_NEAR(keyframes.position(0, 1 - 1e-4), 5.0, 1e-6);
  EXPECT_NEAR(keyframes.position(0, 2 + 1e-4), 5.0, 1e-6);
}

TEST(Keyframes, CubicHasContinuousVelocity) {
  const Keyframes keyframes = make({0, 1, 1.5, 4}, {0, 1, 4, 5}, Interpolation::kCubic);
  const double h = 1e-6;
  for (double t : {1.0, 1.5}) {
    const double before = (keyframes.position(0, t) - keyframes.position(0, t - h)) / h;
    const double after = (keyframes.position(0, t + h) - keyframes.position(0, t)) / h;
    EXPECT_NEAR(before, after, 1e-4);
  }
}

TEST(Keyframes, LoopRepeats) {
  const Keyframes keyframes = make({1, 2, 3}, {0, 1, 0}, Interpolation::kLinear, true);
  EXPECT_EQ(keyframes.position(0, 0), 0.0);
  EXPECT_DOUBLE_EQ(keyframes.position(0, 1.5), 0.5);
  EXPECT_NEAR(keyframes.position(0, 3.5), 0.5, 1e-12);
  EXPECT_NEAR(keyframes.position(0, 1001.5), 0.5, 1e-9);
}

TEST(Keyframes, OneKeyframeHolds) {
  const Keyframes keyframes = make({0}, {4}, Interpolation::kCubic);
  EXPECT_EQ(keyframes.position(0, 0), 4.0);
  EXPECT_EQ(keyframes.position(0, 7), 4.0);
}

TEST(Keyframes, RefusesWhatItCannotPlay) {
  const double nan = std::nan("");
  const auto refused = [](const std::vector<double>& times, const std::vector<double>& values,
                          bool loop, const std::vector<std::string>& parts) {
    expect_refusal([&] { make(times, values, Interpolation::kCubic, loop); }, parts);
  };
  refused({}, {}, false, {"no keyframe"});
  refused({-1}, {0}, false, {"keyframes[0].time"});
  refused({nan}, {0}, false, {"keyframes[0].time"});
  refused({0, 0}, {0, 0}, false, {"keyframes[1].time"});
  refused({0, 1}, {0, nan}, false, {"position"});
  refused({0, 1}, {0, 1e9}, false, {"position"});
  refused({0, 1}, {0}, false, {"1 x 1"});
  refused({0, 1}, {0, 1}, true, {"loop"});
  refused({0}, {0}, true, {"loop"});
}

TEST(ReadKeyframes, ReadsEveryKey) {
  const SceneFiles files;
  const Keyframes keyframes = read_keyframes(files.write(
      "k.yaml",
      "joints: [a, b]\ninterpolation: linear\nloop: true\nkeyframes:\n  - {time: 0, "
      "positions: [0, 1]}\n  - {time: 1, positions: [2, 3]}\n  - {time: 2, positions: [0, "
      "1]}\n"));
  EXPECT_EQ(keyframes.joints(), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(keyframes.loop());
  EXPECT_EQ(keyframes.end_time(), 2.0);
  EXPECT_DOUBLE_EQ(keyframes.position(1, 0.25), 1.5);
}

TEST(ReadKeyframes, ReadsTheTowelsDemo) {
  const Keyframes keyframes =
      read_keyframes(std::string(PLIANT_SOURCE_DIR) + "/config/robots/demo_cloth_motion.yaml");
  EXPECT_EQ(keyframes.joints().size(), 6u);
  EXPECT_FALSE(keyframes.loop());
}

struct KeyframesCase {
  const char* from;
  const char* to;
  std::vector<std::string> parts;
};

std::ostream& operator<<(std::ostream& stream, const KeyframesCase& given) {
  return stream << given.from << " -> " << given.to;
}

constexpr const char* kFile =
    "joints: [a, b]\ninterpolation: cubic\nloop: false\nkeyframes:\n"
    "  - {time: 0, positions: [0, 1]}\n  - {time: 1, positions: [2, 3]}\n";

const KeyframesCase kKeyframesCases[] = {
    {"joints: [a, b]\n", "", {":1: 'joints' is missing"}},
    {"joints: [a, b]", "joint: [a, b]", {":1: unknown key 'joint'", "'joints'?"}},
    {"joints: [a, b]", "joints: [a, a]", {":1: joint 'a' is listed twice"}},
    {"joints: [a, b]", "joints: []", {":1: joints is an empty list"}},
    {"joints: [a, b]", "joints: [a, [b]]", {":1: joints[1] is a list"}},
    {"cubic", "cubc", {":2: ", "did you mean 'cubic'?"}},
    {"false", "no", {":3: ", "true or false"}},
    {"false", "true", {":5: ", "loop"}},
    {"time: 0", "tme: 0", {":5: unknown key 'tme' in keyframes[0]", "'time'?"}},
    {"time: 0, ", "", {":5: keyframes[0]: 'time' is missing"}},
    {"time: 0", "time: -1", {":5: ", "'time' is '-1'"}},
    {"time: 1", "time: 0", {":6: keyframes[1].time", "after the one before"}},
    {"time: 1", "time: .inf", {":6: ", "'.inf'"}},
    {"[2, 3]", "[2]", {":6: keyframes[1].positions has 1 items", "2 finite numbers"}},
    {"[2, 3]", "[2, x]", {":6: keyframes[1].positions is 'x'"}},
    {"[2, 3]", "[2, 1e7]", {":6: keyframes[1].positions is '1e7'"}},
    {", positions: [2, 3]", "", {":6: keyframes[1]: 'positions' is missing"}},
};

class KeyframeRefusal : public ::testing::TestWithParam<KeyframesCase> {};

TEST_P(KeyframeRefusal, NamesFileLineAndKey) {
  const SceneFiles files;
  const std::string path = files.write("k.yaml", replaced(kFile, GetParam().from, GetParam().to));
  std::vector<std::string> parts = GetParam().parts;
  parts.push_back(path);
  expect_refusal([&] { read_keyframes(path); }, parts);
}

INSTANTIATE_TEST_SUITE_P(Table, KeyframeRefusal, ::testing::ValuesIn(kKeyframesCases));

TEST(KeyframeSource, DrivesTheJointsItNames) {
  const Robot robot = Robot::from_text(kLiftUrdf);
  const auto source = make_keyframe_source(
      Keyframes({"lift"}, {0, 1}, Eigen::RowVector2d(0, 1), Interpolation::kLinear, false), robot,
      "W");
  std::vector<double> positions = {9};
  source->positions(0.25, positions);
  EXPECT_DOUBLE_EQ(positions[0], 0.25);
}

TEST(KeyframeSource, RefusesUnknownJointsAndPositionsBeyondLimits) {
  const Robot robot = Robot::from_text(kLiftUrdf);
  const auto refused = [&](const char* joint, double last, const std::vector<std::string>& parts) {
    const Keyframes keyframes({joint}, {0, 1}, Eigen::RowVector2d(0, last), Interpolation::kLinear,
                              false);
    expect_refusal([&] { make_keyframe_source(keyframes, robot, "W"); }, parts);
  };
  refused("lfit", 1.0, {"W: ", "'lfit'", "did you mean 'lift'?"});
  refused("lift", 1.5, {"W: keyframes[1]", "'lift' at 1.5", "-1 to 1"});
}

TEST(KeyframeSource, JointsThatMimicOrAreFixedAreNamedWithTheCure) {
  const Robot robot = Robot::from_text(R"(<robot name="r"><link name="a"/><link name="b"/>
    <link name="c"/><link name="d"/>
    <joint name="left" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="1" velocity="1" effort="1"/></joint>
    <joint name="right" type="prismatic"><parent link="a"/><child link="c"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="1" velocity="1" effort="1"/><mimic joint="left"/></joint>
    <joint name="glue" type="fixed"><parent link="a"/><child link="d"/></joint></robot>)");
  const auto refused = [&](const char* joint, const std::vector<std::string>& parts) {
    const Keyframes keyframes({joint}, {0, 1}, Eigen::RowVector2d(0, 0.5), Interpolation::kLinear,
                              false);
    expect_refusal([&] { make_keyframe_source(keyframes, robot, "W"); }, parts);
  };
  refused("right", {"W: ", "joint 'right' mimics 'left'", "name 'left' instead"});
  refused("glue", {"W: ", "joint 'glue' is fixed", "leave it out"});
}

// Against the greatest difference quotient of many small steps.
TEST(Keyframes, TopSpeedIsTheGreatestSlope) {
  for (const auto interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
    const Keyframes keyframes({"a"}, {0.0, 1.0, 1.5, 4.0}, Eigen::RowVector4d(0.0, 0.3, 0.8, 0.1),
                              interpolation, false);
    double top = 0.0, at = 0.0;
    constexpr double kStep = 1e-4;
    for (double t = 0.0; t < 4.0; t += kStep) {
      const double speed =
          std::abs(keyframes.position(0, t + kStep) - keyframes.position(0, t)) / kStep;
      if (speed > top) at = t;
      top = std::max(top, speed);
    }
    const Keyframes::Speed speed = keyframes.top_speed(0);
    EXPECT_NEAR(speed.value, top, 1e-3 * top);
    EXPECT_LE(speed.from, at + 1e-9);
    EXPECT_GE(speed.until, at);
  }
}

}  // namespace
}  // namespace pliant
