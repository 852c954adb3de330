#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/run_statistics.h"
#include "pliant/app/scene_options.h"
#include "pliant/app/scene_parameter.h"
#include "pliant/effects/registry.h"
#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

constexpr int kMeasuredSteps = 20;

/// Memory of this process that is in RAM [bytes].
double resident_memory() {
  double total = 0.0, resident = 0.0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void print_body(const Body& body) {
  const Particles& particles = body.particles();
  int fixed = 0;
  for (int i = 0; i < particles.size(); ++i) fixed += particles.is_fixed(i) ? 1 : 0;
  fmt::print("body {}: model {}, {} vertices ({} fixed), {} triangles, {:.6g} kg\n", body.name,
             body.model->name(), particles.size(), fixed, body.model->surface_triangles().cols(),
             particles.mass.sum());
  fmt::print("  solver {}:", body.solver_setting.first);
  for (const auto& [name, value] : body.solver_setting.second) fmt::print(" {}={}", name, value);
  fmt::print("{}\n", body.solver_setting.second.empty() ? " (defaults)" : "");
  const ProjectiveSystem* system = body.model->system().as_projective();
  if (system == nullptr) return;
  for (const auto& set : system->elements) {
    fmt::print("  elements {}: {}\n", set->name(), set->size());
  }
}

void print_named(const std::string& kind, const NamedParameters& named) {
  fmt::print("{} {}:", kind, named.name);
  for (const auto& [name, value] : named.parameters) fmt::print(" {}={}", name, value);
  fmt::print("{}", named.parameters.empty() ? " (defaults)" : "");
  if (!named.bodies.empty()) fmt::print(", on {} alone", fmt::join(named.bodies, ", "));
  fmt::print("\n");
}

void print_pairs(const BodyPairsSpec& pairs) {
  for (const BodyPairSpec& pair : pairs.touching) {
    fmt::print("  pair {}, {}:", pair.one, pair.other);
    if (pair.numbers.friction) fmt::print(" friction={:g}", *pair.numbers.friction);
    if (pair.numbers.thickness) fmt::print(" thickness={:g}", *pair.numbers.thickness);
    fmt::print("\n");
  }
  for (const BodyPairSpec& pair : pairs.left_out) {
    fmt::print("  pair {}, {}: left out\n", pair.one, pair.other);
  }
  if (pairs.only_named) fmt::print("  no other pairs\n");
}

void print_robot(const Robot& robot, const RobotSpec& spec) {
  fmt::print("robot {}: {} links, {} joints{}\n", robot.name(), robot.link_names().size(),
             robot.joint_names().size(),
             spec.keyframes_path.empty() ? "" : ", moved by " + spec.keyframes_path);
  for (std::size_t j = 0; j < robot.joint_names().size(); ++j) {
    const int joint = static_cast<int>(j);
    const Robot::Limits limits = robot.limits(joint);
    fmt::print("  joint {}: {:g} to {:g} {}, starts at {:g}\n", robot.joint_names()[j],
               limits.lower, limits.upper, robot.unit(joint), robot.initial_positions()[j]);
  }
  for (const auto& [mimic, followed] : robot.mimics()) {
    fmt::print("  joint {}: mimics {}\n", mimic, followed);
  }
  for (const Robot::FreeJoint& joint : robot.free_joints()) {
    fmt::print("  joint {}: {}, by tf in a node, from {} to {}\n", joint.name, joint.type,
               joint.parent, joint.child);
  }
}

void print_scene(const LoadedScene& scene) {
  const SceneSpec& spec = scene.spec;
  fmt::print("scene {} ({})\n", spec.name, spec.path);
  if (!spec.description.empty()) fmt::print("  {}\n", spec.description);
  fmt::print("time step: {:g} s\n", spec.time_step);
  for (const Body& body : scene.world->bodies()) print_body(body);
  for (const Obstacle& obstacle : scene.world->obstacles()) {
    fmt::print("obstacle {}: {}{}\n", obstacle.name, obstacle.shape->name(),
               obstacle.link.empty() ? "" : ", on link " + obstacle.link);
  }
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    print_robot(*scene.robots[r].robot, spec.robots[r]);
  }
  for (const NamedParameters& effect : spec.effects) {
    print_named("effect", effect);
    if (!effect_registry().find(effect.name).pair_parameters.empty()) print_pairs(spec.body_pairs);
  }
}

/// Steps the world and prints what each phase takes; returns the exit code.
int print_times(World& world) {
  RunStatistics statistics;
  // The first step allocates and fills caches: it is not typical.
  for (int i = 0; i <= kMeasuredSteps; ++i) {
    const Timer timer;
    if (!world.step()) {
      std::cerr << "error: " << world.failure() << "\n";
      return kNotFinite;
    }
    if (i > 0) statistics.add(world, timer.seconds());
  }
  const double mean = statistics.seconds() / kMeasuredSteps;
  fmt::print("time of a step (mean of {}): {:.4f} ms, {:.3g} times real time\n", kMeasuredSteps,
             1e3 * mean, world.time_step() / mean);
  for (const auto& [name, seconds] : statistics.phases()) {
    fmt::print("  {:<16} {:.4f} ms  {:5.1f} %\n", name, 1e3 * seconds / kMeasuredSteps,
               100.0 * seconds / statistics.seconds());
  }
  return kOk;
}

/// A row a path: its number, and what the registry allows.
int print_values(const SceneOptions& options, const std::vector<std::string>& paths) {
  const LoadedScene scene = load_scene(options);
  std::string text = "path,value,minimum,minimum_is_allowed,maximum,unit,meaning\n";
  for (const std::string& path : paths) {
    const auto found = scene_parameter(scene.spec, path);
    if (path == "time_step") {
      text += fmt::format("{},{},0,0,inf,s,\n", path, scene.spec.time_step);
    } else if (!found) {
      text += table_cell(path) + ",,,,,,\n";
    } else {
      const ParameterSpec& spec = found->spec;
      text += fmt::format("{},{},{},{:d},{},{},{}\n", table_cell(path), found->value, spec.min,
                          spec.min_is_allowed, spec.max, spec.unit, table_cell(spec.meaning));
    }
  }
  fmt::print("{}", text);
  std::fflush(stdout);
  return kOk;
}

int describe(const SceneOptions& options) {
  const double before = resident_memory();
  LoadedScene scene = load_scene(options);
  print_scene(scene);
  const int code = print_times(*scene.world);
  const double after = resident_memory();
  fmt::print("memory: {:.1f} MB, of which {:.1f} MB came with the scene\n", 1e-6 * after,
             1e-6 * (after - before));
  std::fflush(stdout);
  return code;
}

}  // namespace

void add_describe_command(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "describe", "Say what a scene holds, and what each phase of a step costs");
  auto options = std::make_shared<SceneOptions>();
  add_scene_options(*command, *options);
  auto paths = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("--value", *paths,
                   "Instead, as CSV: the number at a path, as bodies[0].material.bending, and what "
                   "the registry allows; empty cells where no registry describes it")
      ->type_name("PATH");
  command->callback([options, paths, &exit_code] {
    exit_code = paths->empty() ? describe(*options) : print_values(*options, *paths);
  });
}

}  // namespace pliant
