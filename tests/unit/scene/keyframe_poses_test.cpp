#include <gtest/gtest.h>

#include <cmath>

#include "pliant/scene/robot/motion/inverse_kinematics.h"
#include "pliant/scene/robot/motion/keyframe_file.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

const Robot& posed_arm() {
  static const Robot arm =
      Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/arm.urdf");
  return arm;
}

// The arm bent in front of its foot, then over two places with its tool down.
constexpr const char* kPosed = R"(joints: [shoulder_yaw, shoulder_pitch, upper_arm_roll, elbow,
         forearm_roll, wrist_pitch, flange_roll, left_finger_joint]
interpolation: cubic
keyframes:
  - {time: 0, positions: [0, 0.3, 0, 1.6, 0, 1.2, 0, 0.04]}
  - {time: 1, pose: {link: tool, position: [0.5, 0.0, 0.3], rotation_rpy: [3.14159265, 0, 0]}}
  - {time: 2, pose: {link: tool, position: [0.4, 0.3, 0.1], rotation_rpy: [3.14159265, 0, 0.7]}}
  - {time: 3, positions: {left_finger_joint: 0.01}}
  - time: 4
    pose: {link: tool, position: [0.4, 0.3, 0.3], rotation_rpy: [3.14159265, 0, 0.7]}
    positions: {left_finger_joint: 0.02}
)";

Keyframes posed(const std::string& text) {
  const SceneFiles files;
  return read_keyframes(files.write("k.yaml", text), &posed_arm());
}

std::vector<double> positions_at(const Keyframes& keyframes, double time) {
  std::vector<double> positions = posed_arm().initial_positions();
  for (std::size_t j = 0; j < keyframes.joints().size(); ++j) {
    positions[static_cast<std::size_t>(*posed_arm().joint_index(keyframes.joints()[j]))] =
        keyframes.position(static_cast<int>(j), time);
  }
  return positions;
}

Eigen::Isometry3d tool_at(const Keyframes& keyframes, double time) {
  return posed_arm().link_pose("tool", positions_at(keyframes, time));
}

Eigen::Isometry3d tool_down(const Eigen::Vector3d& position, double yaw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position;
  pose.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

double distance_from_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b) {
  return (p - a).cross((b - a).normalized()).norm();
}

TEST(KeyframePoses, TheLinkIsWhereTheKeyframeSays) {
  const Keyframes keyframes = posed(kPosed);
  const auto expect_pose = [&](double time, const Eigen::Isometry3d& pose) {
    EXPECT_LT((tool_at(keyframes, time).matrix() - pose.matrix()).norm(), 1e-6) << time;
  };
  expect_pose(1.0, tool_down({0.5, 0.0, 0.3}, 0.0));
  expect_pose(2.0, tool_down({0.4, 0.3, 0.1}, 0.7));
  expect_pose(3.0, tool_down({0.4, 0.3, 0.1}, 0.7));
  expect_pose(4.0, tool_down({0.4, 0.3, 0.3}, 0.7));
  EXPECT_DOUBLE_EQ(keyframes.position(3, 0.0), 1.6);
}

TEST(KeyframePoses, TheWayIsStraightAndWithinLimits) {
  const Eigen::Vector3d from(0.5, 0.0, 0.3), to(0.4, 0.3, 0.1);
  for (const char* interpolation : {"cubic", "linear"}) {
    const Keyframes keyframes = posed(replaced(kPosed, "cubic", interpolation));
    double done = 0.0;
    for (double t = 1.0; t <= 2.0; t += 0.0013) {
      const Eigen::Isometry3d pose = tool_at(keyframes, t);
      EXPECT_LT(distance_from_line(pose.translation(), from, to), 1e-4) << t;
      EXPECT_LT(pose.linear().col(2).z(), -1.0 + 1e-6) << t;
      const double gone = (pose.translation() - from).norm() / (to - from).norm();
      EXPECT_GE(gone, done - 1e-9) << t;
      const double s = t - 1.0;
      const double share = *interpolation == 'l' ? s : s * s * (3.0 - 2.0 * s);
      EXPECT_NEAR(gone, share, 2e-3) << t;
      done = gone;
      const std::vector<double> positions = positions_at(keyframes, t);
      for (std::size_t j = 0; j < positions.size(); ++j) {
        const Robot::Limits limits = posed_arm().limits(static_cast<int>(j));
        EXPECT_TRUE(positions[j] >= limits.lower && positions[j] <= limits.upper);
      }
    }
    EXPECT_NEAR(done, 1.0, 1e-2);
  }
}

TEST(KeyframePoses, WithPathJointsTheWayIsNotStraight) {
  const Keyframes keyframes = posed(replaced(kPosed, "rotation_rpy: [3.14159265, 0, 0.7]}}",
                                             "rotation_rpy: [3.14159265, 0, 0.7], path: joints}}"));
  const Eigen::Isometry3d middle = tool_at(keyframes, 1.5);
  EXPECT_GT(distance_from_line(middle.translation(), {0.5, 0.0, 0.3}, {0.4, 0.3, 0.1}), 0.002);
  EXPECT_LT((tool_at(keyframes, 2.0).matrix() - tool_down({0.4, 0.3, 0.1}, 0.7).matrix()).norm(),
            1e-6);
}

TEST(KeyframePoses, OtherJointsMoveMeanwhile) {
  const Keyframes keyframes = posed(kPosed);
  EXPECT_DOUBLE_EQ(keyframes.position(7, 1.5), 0.04);
  EXPECT_DOUBLE_EQ(keyframes.position(7, 3.0), 0.01);
  EXPECT_NEAR(keyframes.position(7, 3.5), 0.015, 1e-5);
  EXPECT_DOUBLE_EQ(keyframes.position(7, 4.0), 0.02);
  // Joints that a map does not name stand still.
  for (int j = 0; j < 7; ++j) {
    EXPECT_EQ(keyframes.position(j, 2.5), keyframes.position(j, 2.0)) << j;
  }
}

TEST(KeyframePoses, CubicStandsStillAtPoses) {
  const Keyframes keyframes = posed(kPosed);
  const double h = 1e-4;
  for (const double t : {1.0, 2.0, 3.0}) {
    const Eigen::Vector3d before = tool_at(keyframes, t - h).translation();
    const Eigen::Vector3d after = tool_at(keyframes, t + h).translation();
    EXPECT_LT((after - before).norm() / (2 * h), 2e-3) << t;
  }
}

TEST(KeyframePoses, LoopsOverPositionsAtBothEnds) {
  const std::string text =
      replaced(kPosed, "interpolation: cubic", "interpolation: cubic\nloop: true") +
      "  - {time: 5, positions: [0, 0.3, 0, 1.6, 0, 1.2, 0, 0.04]}\n";
  const Keyframes keyframes = posed(text);
  for (const double t : {0.5, 1.7, 4.5}) {
    EXPECT_LT((tool_at(keyframes, t).matrix() - tool_at(keyframes, t + 5.0).matrix()).norm(), 1e-9);
  }
}

TEST(KeyframePoses, PlaysOnTheRobot) {
  const auto source = make_keyframe_source(posed(kPosed), posed_arm(), "W");
  std::vector<double> positions = posed_arm().initial_positions();
  source->positions(2.0, positions);
  EXPECT_LT(
      (posed_arm().link_pose("tool", positions).matrix() - tool_down({0.4, 0.3, 0.1}, 0.7).matrix())
          .norm(),
      1e-6);
}

TEST(KeyframePoses, TheDemoIsWithinReach) {
  const Keyframes keyframes = read_keyframes(
      std::string(PLIANT_SOURCE_DIR) + "/config/robots/demo_motion.yaml", &posed_arm());
  EXPECT_NO_THROW(make_keyframe_source(keyframes, posed_arm(), "W"));
  EXPECT_GT(keyframes.samples().times.size(), 200u);
}

struct PoseCase {
  const char* from;
  const char* to;
  std::vector<std::string> parts;
};

std::ostream& operator<<(std::ostream& stream, const PoseCase& given) {
  return stream << given.from << " -> " << given.to;
}

const PoseCase kPoseCases[] = {
    {"{link: tool, position: [0.5",
     "{link: tol, position: [0.5",
     {":6: keyframes[1].pose: unknown link 'tol'", "'tool'?"}},
    {"{link: tool, position: [0.5", "{link: base, position: [0.5", {":6: ", "no joint moves"}},
    {"{link: tool, position: [0.5", "{link: right_finger, position: [0.5", {":6: ", "mimics"}},
    {"{link: tool, position: [0.5",
     "{position: [0.5",
     {":6: keyframes[1].pose: 'link' is missing"}},
    {"position: [0.5, 0.0, 0.3], ", "", {":6: keyframes[1].pose", "'position' is missing"}},
    {", rotation_rpy: [3.14159265, 0, 0]}",
     "}",
     {":6: keyframes[1].pose", "'rotation_rpy' is missing"}},
    {"rotation_rpy: [3.14159265, 0, 0]",
     "rotation_ryp: [3.14159265, 0, 0]",
     {":6: unknown key 'rotation_ryp' in keyframes[1].pose", "'rotation_rpy'?"}},
    {"[0.5, 0.0, 0.3]", "[0.5, 0.0]", {":6: keyframes[1].pose"}},
    {"rotation_rpy: [3.14159265, 0, 0]",
     "rotation_rpy: [3.14159265, 0, 0], path: strait",
     {":6: ", "did you mean 'straight'?"}},
    {"[0.5, 0.0, 0.3]",
     "[1.3, 0.0, 0.3]",
     {":6: keyframes[1].pose: link 'tool' does not reach it", " m and ", "degrees away",
      "at position ["}},
    // Straight up through the foot: reached, but not on a straight path.
    {"[0.4, 0.3, 0.1], rotation_rpy: [3.14159265, 0, 0.7]",
     "[-0.5, 0.0, 0.3], rotation_rpy: "
     "[3.14159265, 0, 0]",
     {":7: keyframes[2].pose: ", "straight path", "path: joints"}},
    {"  - {time: 0, positions: [0, 0.3, 0, 1.6, 0, 1.2, 0, 0.04]}\n",
     "",
     {":5: keyframes[0] has a 'pose'", "first keyframe"}},
    {"positions: [0, 0.3, 0, 1.6, 0, 1.2, 0, 0.04]",
     "positions: {elbow: 1}",
     {":5: keyframes[0].positions has no 'shoulder_yaw'"}},
    {"{left_finger_joint: 0.01}",
     "{left_finger_jont: 0.01}",
     {":8: unknown key 'left_finger_jont' in keyframes[3].positions", "'left_finger_joint'?"}},
    {"{left_finger_joint: 0.01}", "{left_finger_joint: x}", {":8: keyframes[3].positions", "'x'"}},
    {"{left_finger_joint: 0.02}",
     "{elbow: 1}",
     {":10: keyframes[4].positions: joint 'elbow' moves link 'tool'"}},
    {"flange_roll, left",
     "left",
     {":6: keyframes[1].pose: link 'tool' is moved by joint "
      "'flange_roll', which 'joints' lacks"}},
    {"shoulder_yaw,", "shoulder_jaw,", {"k.yaml: unknown joint 'shoulder_jaw'", "'shoulder_yaw'?"}},
};

class PoseRefusal : public ::testing::TestWithParam<PoseCase> {};

TEST_P(PoseRefusal, NamesFileLineAndKey) {
  std::string text = replaced(kPosed, GetParam().from, GetParam().to);
  if (std::string(GetParam().to) == "left") text = replaced(text, "1.2, 0, 0.04", "1.2, 0.04");
  std::vector<std::string> parts = GetParam().parts;
  parts.emplace_back("k.yaml");
  expect_refusal([&] { posed(text); }, parts);
}

INSTANTIATE_TEST_SUITE_P(Table, PoseRefusal, ::testing::ValuesIn(kPoseCases));

TEST(KeyframePoses, NeedTheRobot) {
  const SceneFiles files;
  const std::string path = files.write("k.yaml", kPosed);
  expect_refusal([&] { read_keyframes(path); },
                 {"k.yaml:6: keyframes[1] has a 'pose'", "URDF has to be known"});
}

TEST(KeyframePoses, LoopRefusesAPoseThatIsNotTheStart) {
  expect_refusal(
      [] { posed(replaced(kPosed, "interpolation: cubic", "loop: true")); },
      {"k.yaml:5: ", "with loop the last keyframe must have the positions of the first"});
}

}  // namespace
}  // namespace pliant
