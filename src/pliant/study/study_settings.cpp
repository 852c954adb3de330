#include "pliant/study/study_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <iterator>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/yaml_include.h"
#include "pliant/scene/yaml/yaml_map.h"
#include "pliant/study/option_text.h"

namespace pliant {
namespace {

constexpr int kFormat = 1;

/// FNV-1a, 64 bits.
class Hash {
 public:
  void add(const std::string& text) {
    for (char c : text) add_byte(static_cast<unsigned char>(c));
    add_byte(0);  // so that "ab" + "c" differs from "a" + "bc"
  }
  void add(const YamlNode& node) {
    add(fmt::format("{}", static_cast<int>(node.kind)));
    add(node.text);
    for (const YamlNode& item : node.items) add(item);
    for (const YamlEntry& entry : node.entries) {
      add(entry.key);
      add(entry.value);
    }
  }
  void add_file(const std::string& path) {
    if (path.empty()) return;
    std::ifstream file(path, std::ios::binary);
    for (std::istreambuf_iterator<char> byte(file), end; byte != end; ++byte) {
      add_byte(static_cast<unsigned char>(*byte));
    }
    if (!file) throw InputError(path + ": cannot be read");
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_byte(unsigned char byte) { value_ = (value_ ^ byte) * 0x100000001b3ULL; }
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

std::string list(const std::vector<std::string>& items) {
  return fmt::format("\"{}\"", fmt::join(items, ","));
}

template <class Number>
std::string number_list(const std::vector<Number>& numbers) {
  return fmt::format("\"{}\"", fmt::join(numbers, ","));
}

/// Parameters of the scene's own solver, which a study keeps.
std::string kept_parameters(const AccuracyPlan& plan) {
  std::string text = plan.scene.solver.name;
  const SolverSetting setting = solver_setting(plan.scene, plan.scene.solver.name, 0);
  for (const auto& [name, value] : setting.parameters) {
    if (name != "iterations") text += fmt::format(" {}={}", name, value);
  }
  return setting.parameters.empty() ? "" : text;
}

}  // namespace

std::uint64_t scene_hash(const SceneSpec& scene) {
  Hash hash;
  const YamlNode root = read_yaml_with_includes(scene.path, nullptr);
  for (const YamlEntry& entry : root.entries) {
    bool matters = true;
    for (const char* key : {"name", "description", "solver", "threads", "recording"}) {
      matters = matters && entry.key != key;
    }
    if (!matters) continue;
    hash.add(entry.key);
    hash.add(entry.value);
  }
  hash.add(fmt::format("{}", scene.time_step));
  for (const BodySpec& body : scene.bodies) hash.add_file(body.geometry.path);
  for (const ObstacleSpec& obstacle : scene.obstacles) hash.add_file(obstacle.mesh_path);
  for (const RobotSpec& robot : scene.robots) {
    hash.add_file(robot.urdf_path);
    hash.add_file(robot.keyframes_path);
  }
  return hash.value();
}

std::string settings_text(const AccuracyPlan& plan) {
  const AccuracyOptions& options = plan.options;
  const std::string integrations =
      options.time_integrations.empty()
          ? ""
          : fmt::format("time_integrations: {}\n", list(options.time_integrations));
  return fmt::format(
      "# What accuracy.csv was measured with. A study goes on only with the same settings.\n"
      "format: {}\n"
      "scene: \"{}\"\n"
      "scene_hash: \"{:016x}\"\n"
      "solvers: {}\n"
      "iterations: {}\n"
      "time_steps: {}\n"
      "{}"
      "steps: {}\n"
      "samples: {}\n"
      "repeats: {}\n"
      "references: {}\n"
      "solver_parameters: \"{}\"\n",
      kFormat, plan.scene.name, scene_hash(plan.scene), list(options.solvers),
      number_list(options.iterations), number_list(options.time_steps), integrations, plan.steps,
      options.samples, options.repeats, list(options.references), kept_parameters(plan));
}

std::optional<AccuracyOptions> options_from_settings(const std::string& text,
                                                     const std::string& file, std::uint64_t hash) {
  const YamlNode root = parse_yaml(text, file);
  const YamlMap map(root, "",
                    {integer_parameter("format", "", kFormat, kFormat, "of this file"),
                     integer_parameter("steps", "", 1, 1e6, "of the scene's time step"),
                     integer_parameter("samples", "", 1, 1e6, "states"),
                     integer_parameter("repeats", "", 1, 1e6, "of a step")},
                    {"scene", "scene_hash", "solvers", "iterations", "time_steps", "references",
                     "solver_parameters", "time_integrations"});
  const auto value = [&](const std::string& key) { return map.require(key, "a text").text; };
  if (value("scene_hash") != fmt::format("{:016x}", hash)) return std::nullopt;
  AccuracyOptions options;
  options.solvers = parse_names(value("solvers"), file + ": solvers");
  options.iterations = parse_counts(value("iterations"), file + ": iterations");
  const std::string time_steps = value("time_steps");
  if (!time_steps.empty()) options.time_steps = parse_time_steps(time_steps, file + ": time_steps");
  if (map.find("time_integrations") != nullptr) {
    options.time_integrations =
        parse_names(value("time_integrations"), file + ": time_integrations");
  }
  options.references = parse_names(value("references"), file + ": references");
  options.steps = map.integer("steps");
  options.samples = map.integer("samples");
  options.repeats = map.integer("repeats");
  return options;
}

}  // namespace pliant
