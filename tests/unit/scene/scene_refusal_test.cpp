#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

/// kFullScene with `from` replaced by `to` is refused in `line` with a message that holds `parts`.
struct SceneCase {
  const char* from;
  const char* to;
  int line;
  std::vector<std::string> parts;
};

std::ostream& operator<<(std::ostream& stream, const SceneCase& given) {
  return stream << given.from << " -> " << given.to;
}

const SceneCase kSceneCases[] = {
    // The scene itself.
    {"name: test", "nme: test", 1, {"unknown key 'nme' in the file", "did you mean 'name'?"}},
    {"name: test", "name: [a]", 1, {"name is a list", "a text"}},
    {"name: test", "name: ''", 1, {"name is ''", "a text"}},
    {"description: every key", "description: {a: 1}", 29, {"description is a map"}},
    {"time_step: 0.005\n", "", 1, {"'time_step' is missing", "[s]"}},
    {"time_step: 0.005", "time_step:", 2, {"time_step is empty"}},
    {"time_step: 0.005", "time_step: fast", 2, {"'time_step' is 'fast'", "finite number"}},
    {"time_step: 0.005", "time_step: .nan", 2, {"'time_step' is '.nan'"}},
    {"time_step: 0.005", "time_step: nan", 2, {"'time_step' is 'nan'"}},
    {"time_step: 0.005", "time_step: inf", 2, {"'time_step' is 'inf'"}},
    {"time_step: 0.005", "time_step: 1e999", 2, {"'time_step' is '1e999'"}},
    {"time_step: 0.005", "time_step: -0.01", 2, {"'time_step' is '-0.01'", "> 0"}},
    {"time_step: 0.005", "time_step: 0", 2, {"'time_step' is '0'", "> 0"}},
    {"time_step: 0.005", "time_step: 3600", 2, {"'time_step' is '3600'", "<= 1"}},
    {"time_step: 0.005", "time_step: [0.1]", 2, {"'time_step'"}},
    {"time_step: 0.005", "time_step: {a: 1}", 2, {"time_step is a map"}},
    {"threads: 1", "threads: 0", 3, {"'threads' is '0'", ">= 1"}},
    {"threads: 1", "threads: 1.5", 3, {"whole number"}},
    {"threads: 1", "threads: 100000", 3, {"<= 256"}},
    {"threads: 1", "name: again", 3, {"key 'name' is there already, in line 1"}},
    {"limits: {max_speed: 1000,", "limits: {max_sped: 1000,", 28, {"did you mean 'max_speed'?"}},
    {"max_speed: 1000", "max_speed: 0", 28, {"'max_speed' is '0'"}},
    {"every: 10", "every: 0", 27, {"'every' is '0'"}},
    {"every: 10, ", "", 27, {"recording: 'every' is missing"}},
    {"format: ply", "format: stl", 27, {"'stl'", "ply, obj"}},
    // Bodies.
    {"bodies:", "bodis:", 4, {"unknown key 'bodis'", "did you mean 'bodies'?"}},
    {"  - name: towel", "  - nam: towel", 5, {"in bodies[0]", "did you mean 'name'?"}},
    {"  - name: towel", "  - name: a b", 5, {"bodies[0].name is 'a b'", "letters"}},
    {"    model: cloth", "    model: cloht", 6, {"'cloht'", "did you mean 'cloth'?"}},
    {"    model: cloth\n", "", 5, {"'model' is missing"}},
    {"geometry: {grid: {size: [1, 2], vertices: [4, 5]}}",
     "geometry: {}",
     7,
     {"needs one of grid, mesh"}},
    {"geometry: {grid: {size: [1, 2], vertices: [4, 5]}}", "geometry: grid", 7, {"a map"}},
    {"{grid: {size: [1, 2], vertices: [4, 5]}}",
     "{grid: {size: [1, 2], vertices: [4, 5]}, mesh: a}",
     7,
     {"'grid' and 'mesh'; give one"}},
    {"vertices: [4, 5]}}",
     "vertices: [4, 5]}, scale: 2}",
     7,
     {"unknown key 'scale' in bodies[0].geometry"}},
    {"{size: [1, 2], ", "{", 7, {"'size' is missing", "in m"}},
    {"size: [1, 2]", "size: [1]", 7, {"bodies[0].geometry.grid.size has 1 items"}},
    {"size: [1, 2]", "size: [0, 2]", 7, {"bodies[0].geometry.grid.size is '0'", "> 0"}},
    {"size: [1, 2]", "size: [1, -2]", 7, {"is '-2'"}},
    {"size: [1, 2]", "size: [1, nan]", 7, {"is 'nan'"}},
    {"size: [1, 2]", "size: [1, 1e30]", 7, {"is '1e30'"}},
    {"size: [1, 2]", "size: []", 7, {"an empty list"}},
    {"vertices: [4, 5]", "vertices: [1, 5]", 7, {"is '1'", ">= 2"}},
    {"vertices: [4, 5]", "vertices: [4.5, 5]", 7, {"whole numbers"}},
    {"vertices: [4, 5]", "vertices: [10000, 10000]", 7, {"100000000 vertices", "10000000"}},
    {"vertices: [4, 5]", "vertices: [1e300, 1e300]", 7, {"is '1e300'"}},
    {"{grid: {size: [1, 2], vertices: [4, 5]}}",
     "{tube: {radius: 0, length: 1}}",
     7,
     {"bodies[0].geometry.tube", "'radius' is '0'"}},
    {"{grid: {size: [1, 2], vertices: [4, 5]}}",
     "{holed_sheet: {width: 1, height: 1, hole: 0}}",
     7,
     {"bodies[0].geometry.holed_sheet", "'hole' is '0'"}},
    {"position: [0, 0, 1]", "position: [0, 0]", 8, {"bodies[0]: 'position'", "three numbers"}},
    {"position: [0, 0, 1]", "position: [0, 0, 101]", 8, {"'position'", "at most 100 [m]"}},
    {"position: [0, 0, 1]", "position: [0, 0, [1]]", 8, {"position is a list"}},
    {"position: [0, 0, 1]", "position: [0 0 1]", 8, {"bodies[0].position is '0 0 1'"}},
    {"velocity: [0, 0, 0]", "velocity: [0, 0, -2000]", 10, {"at most 1000 [m/s]"}},
    {"color: [0.1, 0.2, 0.3]", "color: [1, 2, 3]", 11, {"bodies[0].color is '2'"}},
    {"color: [0.1, 0.2, 0.3]", "color: [1, 0, 0, 1]", 11, {"4 items"}},
    {"areal_density: 0.2",
     "areal_densty: 0.2",
     12,
     {"unknown key 'areal_densty' in bodies[0].material", "did you mean 'areal_density'?"}},
    {"cloth\n    geometry: {grid: {size: [1, 2], vertices: [4, 5]}}\n    position: [0, 0, 1]\n    "
     "rotation_rpy: [0, 0, 0]\n    velocity: [0, 0, 0]\n    color: [0.1, 0.2, 0.3]\n    material: "
     "{areal_density: 0.2, stretch_warp: 100}\n    fixed: [{corner: lower_left}]",
     "viscoelastic\n    geometry: {block: {size: [1, 1, 1]}, spacing: 0.2}\n    material: "
     "{max_parts: 3}",
     8,
     {"the key 'max_parts' in bodies[0].material is called 'max_substeps' now"}},
    {"areal_density: 0.2", "areal_density: -1", 12, {"bodies[0].material", "'areal_density'"}},
    {"{corner: lower_left}", "{corner: lower_lef}", 13, {"did you mean 'lower_left'?"}},
    {"{corner: lower_left}", "{}", 13, {"fixed[0] needs one of"}},
    {"{corner: lower_left}", "{corner: lower_left, vertices: [1]}", 13, {"needs one of"}},
    {"{corner: lower_left}", "{vertices: [-1]}", 13, {"is '-1'"}},
    {"{corner: lower_left}", "{vertices: [0.5]}", 13, {"whole numbers"}},
    {"{corner: lower_left}", "{vertices: []}", 13, {"an empty list"}},
    {"{corner: lower_left}", "{vertices: [20]}", 13, {"no vertex 20", "19"}},
    {"{corner: lower_left}", "{box: {min: [0, 0, 0]}}", 13, {"'max' is missing"}},
    {"{corner: lower_left}", "{box: {min: [0, 0, 1], max: [1, 1, 0]}}", 13, {"above its 'max'"}},
    {"{corner: lower_left}", "{box: {min: [9, 9, 9], max: [10, 10, 10]}}", 13, {"no vertex"}},
    {"[{corner: lower_left}]", "[]", 13, {"bodies[0].fixed is an empty list"}},
    {"[{corner: lower_left}]", "all", 13, {"bodies[0].fixed is 'all'"}},
    {"{corner: lower_left}", "{sphere: {center: [0, 0, 1], radius: 0}}", 13, {"'radius' is '0'"}},
    {"{corner: lower_left}", "{sphere: {center: [9, 9, 9], radius: 1}}", 13, {"in the sphere"}},
    // Attachments.
    {"fixed: [{corner: lower_left}]",
     "attachments: []",
     13,
     {"bodies[0].attachments is an empty list"}},
    {"fixed: [{corner: lower_left}]", "attachments: {}", 13, {"bodies[0].attachments"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left}]",
     13,
     {"attachments[0]", "'stiffness' is missing"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{corner: lower_left, stiffness: 1}]",
     13,
     {"'name' is missing"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, stiffness: 1}]",
     13,
     {"attachments[0] needs one of corner, vertices, box, sphere"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 0}]",
     13,
     {"'stiffness' is '0'", "N/m"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stifness: 1}]",
     13,
     {"did you mean 'stiffness'?"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 1, to: bal}]",
     13,
     {"attachment 'a' of body 'towel'", "did you mean 'ball'?", "hand"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 1, to: base}]",
     13,
     {"robot link with a collision shape", "'base'"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 1, from: -1}]",
     13,
     {"'from' is '-1'"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 1, from: 2, until: 2}]",
     13,
     {"until is 2 s", "after 'from'"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, sphere: {center: [9, 9, 9], radius: 1}, stiffness: 1}]",
     13,
     {"'a'", "no vertex is in its region"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, vertices: [20], stiffness: 1}]",
     13,
     {"no vertex 20", "19"}},
    {"fixed: [{corner: lower_left}]",
     "attachments: [{name: a, corner: lower_left, stiffness: 1}, {name: a, corner: lower_right, "
     "stiffness: 1}]",
     13,
     {"attachments[1].name 'a' is taken"}},
    // Obstacles.
    {"shape: plane", "shape: plan", 15, {"'plan'", "did you mean 'plane'?"}},
    {"shape: plane, ", "", 15, {"'shape' is missing", "capsule"}},
    {"shape: plane", "shape: plane, radius: 1", 15, {"unknown key 'radius' in obstacles[0]"}},
    {"friction: 0.3", "friction: -0.3", 15, {"obstacles[0]: 'friction' is '-0.3'"}},
    {"name: ball", "name: ground", 16, {"obstacles[1].name 'ground' is taken"}},
    {"radius: 0.1", "radius: 0", 16, {"'radius' is '0'"}},
    {", radius: 0.1", "", 16, {"'radius' is missing"}},
    {"shape: sphere, radius: 0.1", "shape: box, size: [1, 0, 1]", 16, {"size", "1e-09"}},
    {"shape: sphere, radius: 0.1", "shape: capsule, radius: 1", 16, {"'length' is missing"}},
    {"shape: sphere, radius: 0.1", "shape: mesh", 16, {"'mesh' is missing"}},
    {"shape: sphere, radius: 0.1", "shape: mesh, mesh: none.stl", 16, {"'ball'", "none.stl"}},
    {"shape: sphere, radius: 0.1", "shape: mesh, mesh: robot.urdf", 16, {"'ball'", "robot.urdf"}},
    // Robot.
    {"urdf: robot.urdf", "udrf: robot.urdf", 18, {"did you mean 'urdf'?"}},
    {"urdf: robot.urdf", "urdf: none.urdf", 18, {"none.urdf", "no such file"}},
    {"  urdf: robot.urdf\n", "", 18, {"'urdf' is missing"}},
    {"urdf: robot.urdf", "urdf: motion.yaml", 18, {"motion.yaml", "not valid URDF"}},
    {"urdf: robot.urdf", "urdf: package://nope/a.urdf", 18, {"robot.urdf", "'nope'"}},
    {"keyframes: motion.yaml", "keyframes: none.yaml", 19, {"none.yaml"}},
    {"keyframes: motion.yaml", "keyframes: robot.urdf", 19, {"robot.urdf"}},
    {"initial: {lift: 0.1}", "initial: {lfit: 0.1}", 21, {"'lfit'", "did you mean 'lift'?"}},
    {"initial: {lift: 0.1}", "initial: {lift: 5}", 21, {"'lift' is 5", "-1 to 1"}},
    {"initial: {lift: 0.1}", "initial: {lift: nan}", 21, {"robot.initial.lift is 'nan'"}},
    {"initial: {lift: 0.1}", "initial: []", 21, {"robot.initial is an empty list"}},
    {"initial: {lift: 0.1}",
     "link_temperatures: {hnad: 400}",
     21,
     {"robot link with a collision shape 'hnad'", "did you mean 'hand'?"}},
    {"initial: {lift: 0.1}", "link_temperatures: {base: 400}", 21, {"'base'", "hand"}},
    {"initial: {lift: 0.1}",
     "link_temperatures: {hand: -1}",
     21,
     {"robot.link_temperatures.hand is -1", ">= 0", "[K]"}},
    {"initial: {lift: 0.1}",
     "link_temperatures: {hand: nan}",
     21,
     {"robot.link_temperatures.hand is 'nan'"}},
    {"initial: {lift: 0.1}",
     "link_temperatures: 400",
     21,
     {"robot.link_temperatures is '400'", "a map of links"}},
    // Effects and solver.
    {"  contact:", "  contcat:", 24, {"in effects", "did you mean 'contact'?"}},
    {"thickness: 0.002", "thicknes: 0.002", 24, {"did you mean 'thickness'?"}},
    {"thickness: 0.002", "thickness: thin", 24, {"effects.contact: 'thickness' is 'thin'"}},
    {"thickness: 0.002", "thickness:", 24, {"effects.contact.thickness is empty"}},
    {"thickness: 0.002", "thickness: {a: 1}", 24, {"effects.contact.thickness is a map"}},
    {"contact: {thickness: 0.002}", "contact: 0.002", 24, {"effects.contact is '0.002'", "a map"}},
    {"  contact: {thickness: 0.002}\n", "", 24, {"effects.friction", "needs the effect 'contact'"}},
    {"[0, 0, -9.81]", "[0, -9.81]", 23, {"effects.gravity: 'acceleration'", "three numbers"}},
    {"[0, 0, -9.81]", "['0 0', -9.81]", 23, {"acceleration is '0 0'"}},
    {"threads: 1", "gravity: [0, 0, -1]", 3, {"'gravity' is given here and in 'effects'", ":23"}},
    {"name: xpbd", "name: xpdb", 26, {"'xpdb'", "did you mean 'xpbd'?"}},
    {"name: xpbd, ", "", 26, {"'name' is missing", "jacobi"}},
    {"solver: {name: xpbd, iterations: 5}", "solver: xpbd", 26, {"solver is 'xpbd'", "a map"}},
    {"iterations: 5", "iteration: 5", 26, {"in solver", "did you mean 'iterations'?"}},
    {"{name: xpbd, iterations: 5}",
     "{name: verlet, max_parts: 3}",
     26,
     {"the key 'max_parts' in solver is called 'max_substeps' now"}},
    {"iterations: 5", "iterations: -5", 26, {"solver: 'iterations' is '-5'"}},
    {"iterations: 5", "iterations: 1.5", 26, {"a whole number"}},
};

class SceneRefusal : public ::testing::TestWithParam<SceneCase> {};

TEST_P(SceneRefusal, NamesFileLineKeyAndWhatIsAllowed) {
  const SceneFiles files;
  const SceneCase& given = GetParam();
  const std::string path = write_scene(files, replaced(kFullScene, given.from, given.to));
  std::vector<std::string> parts = given.parts;
  parts.push_back(path + ":" + std::to_string(given.line) + ": ");
  expect_refusal([&] { load_scene(path); }, parts);
}

INSTANTIATE_TEST_SUITE_P(Table, SceneRefusal, ::testing::ValuesIn(kSceneCases));

TEST(SceneRefusals, WholeSections) {
  const SceneFiles files;
  const std::string head = "time_step: 0.01\nsolver: {name: xpbd}\n";
  const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_refusal([&] { load_scene(files.write("s.yaml", head + text)); }, parts);
  };
  refused("", {"'bodies' is missing"});
  refused("bodies:\n", {"s.yaml:3: bodies is empty"});
  refused("bodies: []\n", {"s.yaml:3: bodies is an empty list"});
  refused("bodies: {a: 1}\n", {"s.yaml:3: bodies is a map"});
  refused("bodies: [1]\n", {"s.yaml:3: bodies[0] is '1'"});
  const std::string body =
      "{name: a, model: cloth, geometry: {grid: {size: [1, 1], vertices: [2, 2]}}}";
  refused("bodies: [" + body + ", " + body + "]\n", {"bodies[1].name 'a' is taken"});
  const std::string bodies = "bodies: [" + body + "]\n";
  refused(bodies + "obstacles: []\n", {"s.yaml:4: obstacles is an empty list"});
  refused(bodies + "obstacles: [x]\n", {"obstacles[0] is 'x'"});
  refused(bodies + "effects: [gravity]\n", {"s.yaml:4: effects is a list", "a map"});
  refused(bodies + "robot:\n", {"robot is empty"});
}

TEST(SceneRefusals, ManyBodiesTogether) {
  const SceneFiles files;
  std::string text = "time_step: 0.01\nsolver: {name: xpbd}\nbodies:\n";
  for (const char* name : {"a", "b"}) {
    text += std::string("  - {name: ") + name +
            ", model: cloth, geometry: {grid: {size: [1, 1], vertices: [2237, 2237]}}}\n";
  }
  expect_refusal([&] { read_scene(files.write("s.yaml", text)); },
                 {"s.yaml:4", "10008338 vertices together", "10000000"});
}

/// Thirteen bodies, each within what one may have.
struct ManyBodies {
  const char *model, *geometry, *vertices;
};

class ManyOf : public testing::TestWithParam<ManyBodies> {};
INSTANTIATE_TEST_SUITE_P(
    SceneRefusals, ManyOf,
    testing::Values(
        ManyBodies{"cloth", "{tube: {radius: 1, length: 1, around: 2000, along: 2200}}",
                   "57226000 vertices"},
        ManyBodies{"cloth",
                   "{holed_sheet: {width: 1, height: 1, hole: 0.1, side: 500, rings: 2200}}",
                   "57226000 vertices"},
        ManyBodies{"patch", "{block: {size: [1, 1, 1], cells: [120, 120, 120]}}",
                   "23030293 vertices"},
        ManyBodies{"patch", "{sphere: {radius: 1}, tetrahedra: 9999999}", "10833332 vertices"},
        ManyBodies{"viscoelastic", "{block: {size: [1, 1, 1]}, particles: 1900000}",
                   "19760000 vertices"}));

// Before anything is made: reading takes no body's memory, whatever bodies are made from.
TEST_P(ManyOf, AreRefusedTogetherByTheReader) {
  const SceneFiles files;
  const ManyBodies& given = GetParam();
  std::string text = "time_step: 0.01\nsolver: {name: xpbd}\nbodies:\n";
  for (int k = 0; k < 13; ++k) {
    text +=
        fmt::format("  - {{name: b{}, model: {}, geometry: {}}}\n", k, given.model, given.geometry);
  }
  expect_refusal([&] { read_scene(files.write("s.yaml", text)); },
                 {"s.yaml:4", "together", given.vertices, "10000000"});
}

struct HugeShape {
  const char *kind, *model;
  ParameterText size, options;
  std::vector<std::string> parts;
};

TEST(SceneRefusals, HugeShapesNameTheKeysAndTheRange) {
  const HugeShape shapes[] = {
      {"tube",
       "cloth",
       {{"radius", "1"}, {"length", "1"}, {"around", "100000"}, {"along", "100000"}},
       {},
       {"around 100000 and along 100000 make 20000000000 triangles", "product of at most 5000000"}},
      {"holed_sheet",
       "cloth",
       {{"width", "1"}, {"height", "1"}, {"hole", "0.1"}, {"side", "100000"}, {"rings", "10000"}},
       {},
       {"side 100000 and rings 10000 make 8000000000 triangles", "product of at most 1250000"}},
      {"block",
       "patch",
       {{"size", "[1, 1, 1]"}, {"cells", "[10000, 10000, 1]"}},
       {},
       {"10000 x 10000 x 1 cells", "at most 2000000"}},
      {"block",
       "patch",
       {{"size", "[1, 1, 1]"}, {"cells", "[1, 1, 1]"}},
       {{"contact_spacing", "1e-6"}},
       {"contact points", "at most 10000000", "contact_spacing of about 0.0"}},
      {"sphere",
       "patch",
       {{"radius", "1"}, {"level", "4"}},
       {{"surface_level", "256"}},
       {"surface_level", "[1, 44] for these 5120 patches"}},
      {"sphere",
       "patch",
       {{"radius", "1"}},
       {{"cell_size", "0.0134"}},
       {"cell_size is 0.0134 m", "at most 10000000", "0.017 m or more"}},
      {"sphere",
       "viscoelastic",
       {{"radius", "1"}},
       {{"particles", "2000000"}},
       {"particles is 2000000", "allowed for this shape is [1, 10"}},
      {"block",
       "viscoelastic",
       {{"size", "[1, 1, 1]"}},
       {{"spacing", "0.001"}},
       {"a spacing of 0.001 m", "0.00794 m or more"}},
  };
  for (const HugeShape& shape : shapes) {
    const GeometryKind& kind = find_geometry_kind(shape.kind, shape.model);
    const Parameters size = parse_parameters(kind.size, shape.size, "size");
    const Parameters options = parse_parameters(kind.options, shape.options, "options");
    expect_refusal([&] { kind.make("", size, options); }, shape.parts);
  }
}

TEST(SceneRefusals, HugeGridsNameTheKeyAndTheRange) {
  const SceneFiles files;
  const auto refused = [&](const std::string& vertices, const std::vector<std::string>& parts) {
    const std::string text =
        "time_step: 0.01\nsolver: {name: xpbd}\nbodies:\n  - {name: a, model: cloth, geometry: "
        "{grid: {size: [1, 1], vertices: " +
        vertices + "}}}\n";
    expect_refusal([&] { read_scene(files.write("s.yaml", text)); }, parts);
  };
  refused("[100000, 100000]", {"s.yaml:4", "grid.vertices makes 10000000000 vertices",
                               "at most 10000000 triangles", "[2237, 2237]"});
  refused("[3162, 3162]", {"grid.vertices makes 9998244 vertices", "[2237, 2237]"});
  refused("[2, 1000000000]", {"grid.vertices", "two whole numbers", "at most 10000000 triangles"});
}

}  // namespace
}  // namespace pliant
