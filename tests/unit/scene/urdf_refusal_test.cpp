#include <gtest/gtest.h>

#include "pliant/scene/robot.h"
#include "unit/geometry/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

/// kLiftUrdf with `from` replaced by `to` is refused with a message that holds `parts`.
struct UrdfCase {
  const char* from;
  const char* to;
  std::vector<std::string> parts;
};

std::ostream& operator<<(std::ostream& stream, const UrdfCase& given) {
  return stream << given.from << " -> " << given.to;
}

const UrdfCase kUrdfCases[] = {
    {"</robot>", "", {"not valid URDF"}},
    {"<robot name=\"lift\">", "<robot>", {"not valid URDF", "name"}},
    {"<robot name=\"lift\">", "<bot name=\"lift\">", {"not valid URDF"}},
    {"<child link=\"hand\"/>", "<child link=\"hnd\"/>", {"not valid URDF", "hnd"}},
    {"<parent link=\"base\"/>", "<parent link=\"hand\"/>", {":7: link 'hand'", "not connected"}},
    {"<child link=\"hand\"/>", "", {"not valid URDF", "child"}},
    {"<link name=\"base\"/>", "", {"not valid URDF", "base"}},
    {"<link name=\"base\"/>", "<link name=\"base\"/><link name=\"base\"/>", {"base", "not unique"}},
    {"<link name=\"base\"/>", "<link name=\"base\"/><link name=\"other\"/>", {"not valid URDF"}},
    {"type=\"prismatic\"", "type=\"sliding\"", {"not valid URDF", "lift"}},
    {"type=\"prismatic\"", "type=\"floating\"", {":3: joint 'lift'", "floating", "prismatic"}},
    {"type=\"prismatic\"", "type=\"planar\"", {":3: joint 'lift'", "planar"}},
    {"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>", {":3: joint 'lift'", "axis"}},
    {"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0\"/>", {"lift"}},
    {"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 nan\"/>", {"lift"}},
    {"<limit lower=\"-1\" upper=\"1\"",
     "<limit lower=\"1\" upper=\"-1\"",
     {":3: joint 'lift'", "limits from 1 to -1"}},
    {"<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>", "", {"lift", "limit"}},
    {"lower=\"-1\"", "lower=\"x\"", {"lift"}},
    {"<axis", "<mimic joint=\"none\"/><axis", {":3: joint 'lift'", "'none'"}},
    {"<axis", "<mimic joint=\"lift\"/><axis", {":3: joint 'lift'", "mimics itself"}},
    {"size=\"0.1 0.1 0.1\"", "size=\"0.1 0.1 0\"", {":7: link 'hand' collision 0", "box"}},
    {"size=\"0.1 0.1 0.1\"", "size=\"0.1 0.1 -1\"", {":7: link 'hand' collision 0"}},
    {"size=\"0.1 0.1 0.1\"", "size=\"0.1\"", {"not valid URDF"}},
    {"<box size=\"0.1 0.1 0.1\"/>", "<sphere radius=\"0\"/>", {":7: link 'hand' collision 0"}},
    {"<box size=\"0.1 0.1 0.1\"/>", "<cylinder radius=\"1\" length=\"0\"/>", {":7: link 'hand'"}},
    {"<box size=\"0.1 0.1 0.1\"/>", "<capsule radius=\"1\" length=\"1\"/>", {"not valid URDF"}},
    {"<box size=\"0.1 0.1 0.1\"/>", "", {"not valid URDF"}},
    {"<box size=\"0.1 0.1 0.1\"/>",
     "<mesh filename=\"package://nope/a.stl\"/>",
     {":7: link 'hand' collision 0", "'nope'"}},
    {"<box size=\"0.1 0.1 0.1\"/>",
     "<mesh filename=\"file:///none/a.stl\"/>",
     {":7: link 'hand' collision 0", "/none/a.stl"}},
    {"<box size=\"0.1 0.1 0.1\"/>", "<mesh filename=\"a.stl\"/>", {":7: link 'hand'", "relative"}},
    {"<box size=\"0.1 0.1 0.1\"/>",
     "<mesh filename=\"file:///a.stl\" scale=\"1 0 1\"/>",
     {":7: link 'hand'", "scale"}},
    {"<link name=\"base\"/>", "\xff", {"robot_description:2", "not text"}},
};

class UrdfRefusal : public ::testing::TestWithParam<UrdfCase> {};

TEST_P(UrdfRefusal, NamesTheLinkOrJoint) {
  std::vector<std::string> parts = GetParam().parts;
  parts.emplace_back("robot_description");
  expect_refusal([&] { Robot::from_text(replaced(kLiftUrdf, GetParam().from, GetParam().to)); },
                 parts);
}

INSTANTIATE_TEST_SUITE_P(Table, UrdfRefusal, ::testing::ValuesIn(kUrdfCases));

TEST(UrdfRefusals, TextsThatAreNoUrdf) {
  expect_refusal([] { Robot::from_text(""); }, {"robot_description", "empty"});
  expect_refusal([] { Robot::from_text(" \n\t"); }, {"empty"});
  expect_refusal([] { Robot::from_text("hello"); }, {"not valid URDF"});
  expect_refusal([] { Robot::from_text(std::string("<robot\0>", 8)); }, {"not text"});
  expect_refusal([] { Robot::from_text(std::string(20'000'000, ' ')); }, {"longer than"});
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 100'000; ++i) deep += "<a b='>'>";
  expect_refusal([&] { Robot::from_text(deep); }, {"nested deeper"});
}

TEST(UrdfRefusals, Files) {
  const SceneFiles files;
  expect_refusal([&] { Robot::from_file(files.path("none.urdf")); }, {"none.urdf", "no such file"});
  const std::string path = files.write("r.urdf", replaced(kLiftUrdf, "0.1 0.1 0.1", "0 0 0"));
  expect_refusal([&] { Robot::from_file(path); }, {path + ":7: link 'hand'"});
}

TEST(UrdfRefusals, MeshesWithoutAnArea) {
  const SceneFiles files;
  files.write("open.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const std::string path = files.write(
      "r.urdf", replaced(kLiftUrdf, "<box size=\"0.1 0.1 0.1\"/>", "<mesh filename='open.obj'/>"));
  expect_refusal([&] { Robot::from_file(path); },
                 {path + ":7: link 'hand'", "open.obj", "none of its triangles has an area"});
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
                 {path + ":2: link 'base' collision 0", "flat.obj", "link 'base' collision 1",
                  "missing.stl", "no such file"});
}

TEST(UrdfRefusals, LinksThatAreNotOneTree) {
  const std::string joint =
      "<joint name=\"J\" type=\"fixed\"><parent link=\"P\"/><child link=\"C\"/></joint>";
  const auto joined = [&](const char* name, const char* parent, const char* child) {
    return replaced(replaced(replaced(joint, "J", name), "P", parent), "C", child);
  };
  const std::string links = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
  expect_refusal(
      [&] {
        Robot::from_text(links + joined("j1", "a", "b") + joined("j2", "a", "c") +
                         joined("j3", "b", "c") + "</robot>");
      },
      {"link 'c'", "two joints"});
  expect_refusal(
      [&] {
        Robot::from_text(links + joined("j1", "b", "c") + joined("j2", "c", "b") + "</robot>");
      },
      {"not connected"});
  // Without a root, as all of them are in the cycle.
  expect_refusal(
      [&] {
        Robot::from_text(links + joined("j1", "a", "b") + joined("j2", "b", "c") +
                         joined("j3", "c", "a") + "</robot>");
      },
      {"joints form a cycle", "child of none"});
  expect_refusal(
      [&] {
        Robot::from_text("<robot name='r'><link name='a'/>" + joined("j1", "a", "a") + "</robot>");
      },
      {"joints form a cycle"});
}

}  // namespace
}  // namespace pliant
