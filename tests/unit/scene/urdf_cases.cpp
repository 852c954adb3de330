#include "unit/scene/urdf_cases.h"

#include <fmt/format.h>

#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

/// `count` links in a row, or all on one.
std::string many_links(int count, bool in_a_row) {
  std::string urdf = "<robot name='r'><link name='l0'/>\n";
  for (int i = 1; i <= count; ++i) {
    urdf += fmt::format(
        "<link name='l{}'/><joint name='j{}' type='fixed'><parent link='l{}'/><child link='l{}'/>"
        "</joint>\n",
        i, i, in_a_row ? i - 1 : 0, i);
  }
  return urdf + "</robot>\n";
}

std::string nested(int depth) {
  std::string urdf = "<robot name='r'><link name='l'>";
  for (int i = 0; i < depth; ++i) urdf += "<a b='>'>";
  for (int i = 0; i < depth; ++i) urdf += "</a>";
  return urdf + "</link></robot>";
}

class Cases {
 public:
  /// kArmUrdf with `from` replaced by `to` is refused in line `line`; by `good` it is not.
  void refuse(const std::string& name, int line, const std::string& from, const std::string& to,
              std::vector<std::string> parts, const std::string& good) {
    parts.insert(parts.begin(), fmt::format("robot.urdf:{}: ", line));
    cases_.push_back({name, replaced(kArmUrdf, from, to), parts, replaced(kArmUrdf, from, good)});
  }
  void refuse(const std::string& name, int line, const std::string& from, const std::string& to,
              const std::vector<std::string>& parts) {
    refuse(name, line, from, to, parts, from);
  }
  void warn(const std::string& name, int line, const std::string& from, const std::string& to,
            const std::vector<std::string>& parts, const std::string& good) {
    refuse(name, line, from, to, parts, good);
    cases_.back().is_refused = false;
  }
  void put(const std::string& name, const std::string& broken,
           const std::vector<std::string>& parts, const std::string& twin) {
    cases_.push_back({name, broken, parts, twin});
  }

  std::vector<UrdfCase> take() { return std::move(cases_); }

 private:
  std::vector<UrdfCase> cases_;
};

void add_joints(Cases& cases) {
  const std::string type = "type=\"prismatic\"";
  const std::string parent = "    <parent link=\"base\"/>\n";
  const std::string child = "    <child link=\"hand\"/>\n";
  cases.refuse("WrongJointType", 7, type, "type=\"sliding\"",
               {"joint 'lift'", "unknown type 'sliding'", "fixed, revolute, continuous"},
               "type=\"revolute\"");
  cases.refuse("MisspeltJointType", 7, type, "type=\"prismatc\"", {"did you mean 'prismatic'?"},
               "type=\"floating\"");
  cases.refuse("NoJointType", 7, type, "", {"joint 'lift' has no type", "revolute"},
               "type=\"planar\"");
  cases.refuse("NoJointName", 7, "<joint name=\"lift\"", "<joint", {"<joint> has no name"},
               "<joint name=\"raise\"");
  cases.refuse("TwoJointsOfOneName", 19, "name=\"turn\"", "name=\"lift\"",
               {"joint 'lift' is not unique", "line 7"}, "name=\"other\"");
  cases.refuse("NoParent", 7, parent, "", {"joint 'lift' has no parent", "<parent link="});
  cases.refuse("NoChild", 7, child, "", {"joint 'lift' has no child", "<child link="});
  cases.refuse("UnknownParent", 8, "<parent link=\"base\"/>", "<parent link=\"bse\"/>",
               {"joint 'lift'", "unknown link 'bse'", "did you mean 'base'?"});
  cases.refuse("UnknownChild", 9, "<child link=\"hand\"/>", "<child link=\"hadn\"/>",
               {"joint 'lift'", "unknown link 'hadn'", "did you mean 'hand'?"});
  const std::string limit = "<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>";
  cases.refuse("NoLimitOfPrismatic", 7, limit, "", {"joint 'lift' is prismatic", "<limit lower="});
  const std::string turn = "<limit lower=\"-2\" upper=\"2\" velocity=\"3\" effort=\"1\"/>";
  const std::string boundless = replaced(kArmUrdf, turn, "");
  cases.put("NoLimitOfRevolute", boundless,
            {"robot.urdf:19: ", "joint 'turn' is revolute", "make it continuous"},
            replaced(boundless, "type=\"revolute\"", "type=\"continuous\""));
  cases.refuse("LimitsTheWrongWayRound", 7, "lower=\"-1\" upper=\"1\"", "lower=\"1\" upper=\"-1\"",
               {"joint 'lift'", "limits from 1 to -1", "lower must be at most upper"},
               "lower=\"1\" upper=\"1\"");
  cases.refuse("LimitWithoutVelocity", 12, "upper=\"1\" velocity=\"1\"", "upper=\"1\"",
               {"<limit> of joint 'lift' has no velocity", "m/s"}, "upper=\"1\" velocity=\"0\"");
  cases.refuse("AxisOfNoLength", 7, "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>",
               {"joint 'lift' has an axis of no length"}, "<axis xyz=\"0 0 2\"/>");
  cases.refuse("MimicOfAnUnknownJoint", 7, limit, limit + "<mimic joint=\"trun\"/>",
               {"joint 'lift' mimics", "'trun'", "did you mean 'turn'?"},
               limit + "<mimic joint=\"turn\"/>");
  cases.refuse("MimicOfItself", 7, limit, limit + "<mimic joint=\"lift\"/>",
               {"joint 'lift' mimics itself"}, limit + "<mimic joint=\"turn\" offset=\"1\"/>");
  const std::string follows = replaced(kArmUrdf, limit, limit + "<mimic joint=\"turn\"/>");
  cases.put("MimicLoop", replaced(follows, turn, turn + "<mimic joint=\"lift\"/>"),
            {"robot.urdf:7: ", "joint 'lift' mimics itself"}, follows);
}

void add_numbers(Cases& cases) {
  cases.refuse("NanInAnOrigin", 10, "xyz=\"0 0 0.1\"", "xyz=\"0 0 nan\"",
               {"<origin> of joint 'lift'", "'nan' is no finite number"});
  cases.warn("CommasInAnOrigin", 10, "xyz=\"0 0 0.1\"", "xyz=\"0, 0, 0.1\"",
             {"<origin> has xyz=\"0, 0, 0.1\"", "commas are taken for blanks"}, "xyz=\"0 0  0.1\"");
  cases.refuse("InfinityInAnAxis", 11, "<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 inf\"/>",
               {"<axis> of joint 'lift'", "'inf' is no finite number"});
  cases.refuse("NanInALimit", 12, "upper=\"1\" velocity", "upper=\"nan\" velocity",
               {"<limit> of joint 'lift'", "upper=\"nan\""});
  cases.refuse("TwoNumbersForThree", 10, "xyz=\"0 0 0.1\"", "xyz=\"0 0\"",
               {"<origin> of joint 'lift'", "must have 3 numbers", "in m"});
  cases.warn("FourNumbersForThree", 10, "rpy=\"0 0 0\"", "rpy=\"0 0 0 1\"",
             {"<origin> has rpy=\"0 0 0 1\"", "of its 4 numbers the first 3 are taken"},
             "rpy=\"0 0 0\"");
  cases.refuse("OneNumberForABox", 5, "size=\"0.1 0.1 0.1\"", "size=\"0.1\"",
               {"<box> of link 'base'", "must have 3 numbers", "extents in m"});
  cases.refuse("UnitsInANumber", 12, "upper=\"1\" velocity", "upper=\"1m\" velocity",
               {"'1m' is no finite number", "units are not written in URDF"});
  cases.refuse("AWordForANumber", 16, "radius=\"0.1\"", "radius=\"thick\"",
               {"<sphere> of link 'hand'", "'thick' is no finite number"});
  cases.refuse("ThreeColours", 3, "rgba=\"0.5 0.5 0.5 1\"", "rgba=\"0.5 0.5 0.5\"",
               {"<color> of material 'grey'", "4 numbers"}, "rgba=\"1 0 0 1\"");
  cases.refuse("NegativeSize", 16, "radius=\"0.1\"", "radius=\"-0.1\"",
               {"link 'hand' collision 0"});
  cases.warn("MaterialInAGeometry", 16, "<sphere radius=\"0.1\"/>",
             "<sphere radius=\"0.1\"/><material name=\"grey\"/>",
             {"<geometry> of link 'hand' holds <material>", "left out"},
             "<sphere radius=\"0.1\"/>");
  cases.warn("SphereOfNoSize", 16, "radius=\"0.1\"", "radius=\"0\"",
             {"<collision> of link 'hand' is a sphere of no size", "touches nothing"},
             "radius=\"0.001\"");
  cases.refuse("NegativeRadius", 16, "radius=\"0.1\"", "radius=\"-0.1\"",
               {"link 'hand' collision 0"}, "radius=\"0.001\"");
  cases.refuse("CylinderWithoutLength", 26, "radius=\"0.02\" length=\"0.1\"", "radius=\"0.02\"",
               {"<cylinder> of link 'tip' has no length"});
  cases.refuse("NegativeMass", 15, "<mass value=\"1\"/>", "<mass value=\"-1\"/>",
               {"<mass> of link 'hand' is -1 kg"});
  cases.warn("NoMass", 15, "<mass value=\"1\"/>", "<mass value=\"0\"/>",
             {"'hand'", "has a mass of 0 kg", "needs no masses"}, "<mass value=\"0.1\"/>");
  cases.warn("NoInertia", 15,
             "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>", "",
             {"<inertial> of link 'hand' has no <inertia>", "left out"},
             "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>");
}

void add_links(Cases& cases) {
  const std::string base = "<link name=\"base\">";
  cases.refuse("NoLinkName", 4, base, "<link>", {"<link> has no name"});
  cases.refuse("TwoLinksOfOneName", 14, "  <link name=\"hand\">", "  <link name=\"base\">",
               {"link 'base' is not unique", "line 4"});
  const std::string tip = "  <link name=\"tip\">\n";
  const auto spare = [&](const std::string& joint) {
    return "  <link name=\"spare\"/>" + joint + "\n" + tip;
  };
  const auto joined = [](const char* parent, const char* child) {
    return fmt::format(
        "<joint name=\"j\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>",
        parent, child);
  };
  cases.refuse("TwoRoots", 25, tip, spare(""),
               {"link 'spare' is not connected to the root link 'base'", "add a joint"},
               spare(joined("base", "spare")));
  cases.refuse("ChildOfTwoJoints", 25, tip, joined("base", "tip") + "\n" + tip,
               {"link 'tip' is the child of two joints, 'turn' and 'j'", "remove one"},
               spare(joined("hand", "spare")));
  cases.refuse("CycleWithoutARoot", 4, "<joint name=\"turn\"",
               "<joint name=\"back\" type=\"fixed\"><parent link=\"tip\"/><child "
               "link=\"base\"/></joint><joint name=\"turn\"",
               {"joints form a cycle ('back', 'turn', 'lift')", "the child of none"});
  cases.refuse("CycleBesideARoot", 25, "<parent link=\"base\"/>", "<parent link=\"tip\"/>",
               {"link 'tip'", "joints form a cycle ('turn', 'lift')"});
  cases.warn("UnknownMaterial", 5, "<material name=\"grey\"/>", "<material name=\"gray\"/>",
             {"unknown material 'gray'", "did you mean 'grey'?", "<color"},
             "<material name=\"gray\"><color rgba=\"1 1 1 1\"/></material>");
  const std::string grey = "<material name=\"grey\"><color rgba=\"0.5 0.5 0.5 1\"/></material>";
  cases.refuse("TwoMaterialsOfOneName", 4, grey, grey + "\n" + grey,
               {"material 'grey' is not unique", "line 3"},
               grey + "\n" + replaced(grey, "grey", "black"));
}

void add_shapes(Cases& cases) {
  const std::string sphere = "<sphere radius=\"0.1\"/>";
  cases.refuse("UnknownShape", 16, sphere, "<capsule radius=\"1\" length=\"1\"/>",
               {"<geometry> holds <capsule>", "box, sphere, cylinder, mesh"},
               "<cylinder radius=\"1\" length=\"1\"/>");
  cases.refuse("MisspeltShape", 16, sphere, "<shpere radius=\"0.1\"/>", {"did you mean 'sphere'?"});
  cases.refuse("EmptyGeometry", 16, sphere, "",
               {"<collision> of link 'hand' has no geometry", "or remove it"});
  cases.refuse("NoGeometry", 16, "<geometry>" + sphere + "</geometry>", "",
               {"<collision> of link 'hand' has no geometry"});
  const std::string mesh = "filename=\"hand.obj\"";
  cases.refuse("MissingMesh", 17, mesh, "filename=\"hnad.obj\"",
               {"link 'hand' collision 1", "hnad.obj"});
  cases.refuse("MeshThatIsNone", 17, mesh, "filename=\"text.obj\"",
               {"link 'hand' collision 1", "text.obj"});
  cases.refuse("MeshOfAWrongFormat", 17, mesh, "filename=\"scene.yaml\"",
               {"link 'hand' collision 1", "scene.yaml"});
  cases.refuse("MeshOfAnUnknownPackage", 17, mesh, "filename=\"package://nope/hand.obj\"",
               {"package 'nope'", "ROS_PACKAGE_PATH"}, "filename=\"package://arm/hand.obj\"");
  cases.refuse("MeshOfAnUnknownScheme", 17, mesh, "filename=\"http://x/hand.obj\"",
               {"package://NAME/FILE"});
  cases.refuse("MeshWithoutAFile", 17, mesh, "", {"<mesh> of link 'hand' has no filename"});
  cases.refuse("MeshScaledToNothing", 17, "scale=\"1 1 1\"", "scale=\"1 0 1\"", {"scale"},
               "scale=\"1 1 -1\"");
  cases.warn("MisspeltElement", 16, "<collision><geometry>" + sphere + "</geometry></collision>",
             "<colision><geometry>" + sphere + "</geometry></colision>",
             {"<colision> of link 'hand' is left out", "did you mean <collision>?"}, "");
  cases.warn("MisspeltAttribute", 12, "lower=\"-1\"", "lowr=\"-1\"",
             {"<limit> of joint 'lift' has 'lowr'", "did you mean 'lower'?"}, "lower=\"0\"");
}

void add_texts(Cases& cases) {
  const std::string arm = kArmUrdf;
  cases.warn("NoRobotName", 2, "<robot name=\"arm\">", "<robot>",
             {"<robot> has no name", "called 'robot'"}, "<robot name=\"arm\">");
  cases.put("WrongRoot", replaced(replaced(arm, "<robot ", "<bot "), "</robot>", "</bot>"),
            {"robot.urdf:2: ", "the root element is <bot>", "<robot>"}, arm);
  cases.refuse("UnclosedElement", 9, "<child link=\"hand\"/>", "<child link=\"hand\">", {"not XML"},
               "<child link=\"hand\"></child>");
  cases.refuse("XacroMacro", 3, "  <material", "  <xacro:include filename=\"a.xacro\"/><material",
               {"<xacro:include> is xacro", "`xacro ", "robot.urdf > ", "rosrun xacro xacro"});
  cases.refuse("XacroExpression", 16, "radius=\"0.1\"", "radius=\"${thick}\"",
               {"<sphere> is xacro", "expanded"});
  cases.put("Sdf", "<sdf version='1.6'><model name='m'/></sdf>",
            {"robot.urdf:1: ", "<sdf>", "<robot>", "another format"}, arm);
  cases.put("Empty", "", {"robot.urdf: ", "empty"}, arm);
  cases.put("Blank", " \n\t\n", {"robot.urdf: ", "empty"}, arm);
  cases.put("CommentAlone", "<!-- nothing -->\n", {"robot.urdf", "URDF"}, arm);
  cases.put("PlainText", "joints: [a, b]\n", {"robot.urdf", "not valid URDF"}, arm);
  cases.put("Cut", arm.substr(0, arm.size() / 2), {"robot.urdf:", "not XML"}, arm);
  cases.put("NoText", arm + '\0', {"robot.urdf:", "not text"}, arm);
  cases.put("NoLink", "<robot name='r'></robot>", {"robot.urdf:1: ", "has no link"},
            "<robot name='r'><link name='l'/></robot>");
  cases.put("BareAmpersandInAName",
            replaced(kLiftUrdf, "joint name=\"lift\"", "joint name=\"li&t\""),
            {"robot.urdf: ", "the name of a joint is read as", "&amp;"}, kLiftUrdf);
  cases.put("DeepNesting", nested(100'000), {"robot.urdf:1: ", "nested deeper than"}, nested(50));
  cases.put("ChainOfNineThousand", many_links(9'000, true),
            {"robot.urdf:1002: ", "more than 1000 joints away"}, many_links(1'000, true));
  cases.put("TooManyLinks", many_links(10'000, false), {"robot.urdf:1: ", "10001 links", "10000"},
            many_links(2'000, false));
}

}  // namespace

const char* const kArmUrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base">
    <visual><geometry><box size="0.1 0.1 0.1"/></geometry><material name="grey"/></visual>
  </link>
  <joint name="lift" type="prismatic">
    <parent link="base"/>
    <child link="hand"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <link name="hand">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
    <collision><geometry><mesh filename="hand.obj" scale="1 1 1"/></geometry></collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="hand"/>
    <child link="tip"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="1"/>
  </joint>
  <link name="tip">
    <collision><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision>
  </link>
</robot>
)";

std::vector<UrdfCase> urdf_cases() {
  Cases cases;
  add_joints(cases);
  add_numbers(cases);
  add_links(cases);
  add_shapes(cases);
  add_texts(cases);
  return cases.take();
}

}  // namespace pliant
