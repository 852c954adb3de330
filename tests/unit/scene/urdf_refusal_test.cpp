#include <gtest/gtest.h>

#include "pliant/scene/robot/robot.h"
#include "pliant/scene/robot/urdf_lines.h"
#include "support/expect_refusal.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"
#include "unit/scene/urdf_cases.h"

namespace pliant {
namespace {

constexpr const char* kSceneOfRobot = R"(time_step: 0.01
bodies: [{name: towel, model: cloth, geometry: {grid: {size: [1, 1], vertices: [2, 2]}}}]
robot: {urdf: robot.urdf}
effects: {contact: {}}
)";
constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// What `pliant check` says of a scene with that robot.
Outcome check_robot(const std::string& urdf) {
  const SceneFiles files;
  files.write("package.xml", "<package><name>arm</name></package>");
  files.write("hand.obj", kTetrahedron);
  files.write("text.obj", "this is no mesh\n");
  files.write("robot.urdf", urdf);
  return run("check --steps 0 " + files.write("scene.yaml", kSceneOfRobot));
}

class BrokenUrdf : public ::testing::TestWithParam<UrdfCase> {};

TEST_P(BrokenUrdf, CheckNamesFileLineElementAndCure) {
  const Outcome outcome = check_robot(GetParam().broken);
  EXPECT_EQ(outcome.code == 0, !GetParam().is_refused) << outcome.text;
  for (const std::string& part : GetParam().parts) {
    EXPECT_NE(outcome.text.find(part), std::string::npos) << part << " is not in:\n"
                                                          << outcome.text;
  }
}

TEST_P(BrokenUrdf, ItsSoundTwinIsTaken) {
  const Outcome outcome = check_robot(GetParam().twin);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("scene.yaml: OK"), std::string::npos) << outcome.text;
}

INSTANTIATE_TEST_SUITE_P(Ways, BrokenUrdf, ::testing::ValuesIn(urdf_cases()),
                         [](const auto& info) { return info.param.name; });

TEST(UrdfRefusals, TheSoundRobotHasNoWarning) {
  EXPECT_GE(urdf_cases().size(), 40u);
  const Outcome outcome = check_robot(kArmUrdf);
  EXPECT_EQ(outcome.text.find("warning"), std::string::npos) << outcome.text;
}

TEST(UrdfRefusals, Files) {
  const SceneFiles files;
  expect_refusal([&] { Robot::from_file(files.path("none.urdf")); }, {"none.urdf", "no such file"});
  expect_refusal([] { Robot::from_text(std::string(20'000'000, ' ')); },
                 {"robot_description", "longer than"});
}

TEST(UrdfRefusals, TextOfAParameterIsNamedRobotDescription) {
  expect_refusal([] { Robot::from_text(replaced(kLiftUrdf, "0.1 0.1 0.1", "0 0 0")); },
                 {"robot_description:8: link 'hand' collision 0"});
  expect_refusal([] { Robot::from_text(replaced(kLiftUrdf, "0.1 0.1 0.1", "${size}")); },
                 {"robot_description:8: <box> is xacro", "`xacro FILE.xacro > FILE.urdf`"});
}

// What exporters write is no fault.
TEST(UrdfRefusals, MaterialsWithoutNameOrTexture) {
  EXPECT_EQ(Robot::from_text("<robot name='r'><link name='l'><visual><geometry><sphere "
                             "radius='1'/></geometry><material name=''><color rgba='1 1 1 "
                             "1'/><texture filename=''/></material></visual></link></robot>")
                .link_names()
                .size(),
            1u);
}

TEST(UrdfRefusals, MeshesWithoutAnArea) {
  const SceneFiles files;
  files.write("open.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const std::string path = files.write(
      "r.urdf", replaced(kLiftUrdf, "<box size=\"0.1 0.1 0.1\"/>", "<mesh filename='open.obj'/>"));
  expect_refusal([&] { Robot::from_file(path); },
                 {path + ":8: link 'hand'", "open.obj", "none of its triangles has an area"});
}

TEST(UrdfRefusals, TellTheFaultsOfAllMeshesAtOnce) {
  const SceneFiles files;
  files.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const std::string mesh = "<collision><geometry><mesh filename='NAME'/></geometry></collision>";
  const std::string path =
      files.write("r.urdf", replaced(kLiftUrdf, "<link name=\"base\"/>",
                                     "<link name=\"base\">" + replaced(mesh, "NAME", "flat.obj") +
                                         replaced(mesh, "NAME", "missing.stl") + "</link>"));
  expect_refusal([&] { Robot::from_file(path); },
                 {"link 'base' collision 0", "flat.obj", "link 'base' collision 1", "missing.stl",
                  "no such file"});
}

TEST(UrdfMending, APackageThatBeginsWithASlashIsTakenForTheOneThatIsMeant) {
  const std::string mesh = R"(<robot name="r"><link name="l"><collision><geometry>
<mesh filename="package:///arm/hand.obj"/></geometry></collision></link></robot>)";
  const UrdfXml xml = check_urdf_xml(mesh, "robot.urdf");
  ASSERT_EQ(xml.warnings.size(), 1u);
  EXPECT_EQ(xml.warnings[0],
            "robot.urdf:2: 'package:///arm/hand.obj' is taken for 'package://arm/hand.obj'");
  EXPECT_NE(xml.text.find("\"package://arm/hand.obj\""), std::string::npos) << xml.text;
}

TEST(UrdfMending, WhatIsSoundIsReadAsItIs) {
  EXPECT_EQ(check_urdf_xml(kArmUrdf, "robot.urdf").text, kArmUrdf);
}

}  // namespace
}  // namespace pliant
