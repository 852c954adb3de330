#include "pliant/ros/running/what_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pliant/models/solver_registry.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

/// One to try for all bodies instead of the solvers that run; empty: there is none.
std::string other_solver(const World& world) {
  for (const char* name : {"xpbd", "jacobi", "midpoint", "newmark"}) {
    const std::vector<std::string>& models = all_solvers().find(name).models;
    bool suits = true, runs = true;
    for (const Body& body : world.bodies()) {
      suits = suits && std::count(models.begin(), models.end(), body.model->name()) > 0;
      runs = runs && body.solver->name() == name;
    }
    if (suits && !runs) return name;
  }
  return "";
}

/// What a body is and what moves it, at first: later steps may take another backend.
std::string body_text(const Body& body, const std::string& topics) {
  return fmt::format("{}: {}, {} vertices, solver {} on {}{}", body.name, body.model->name(),
                     body.particles().size(), body.solver->name(),
                     body.group->solver().runs_on_gpu() ? "cuda" : "cpu", topics);
}

}  // namespace

std::string what_runs(const Simulation& simulation, const std::vector<std::string>& topics,
                      const std::string& node) {
  const World& world = simulation.world();
  const BodyNames& names = simulation.names();
  std::string text = fmt::format("\n  scene      {}", simulation.spec().path);
  for (std::size_t b = 0; b < names.size(); ++b) {
    const std::string space = node + "/" + names.graph_name(b);
    const std::string own =
        names.size() == 1 ? "" : fmt::format(", topics {}/surface {}/points", space, space);
    text += "\n  body       " + body_text(world.bodies()[b], own);
  }
  text += fmt::format("\n  time step  {:g} s\n  topics     {}", world.time_step(),
                      fmt::join(topics, " "));
  text += fmt::format(
      "\n  try        rosservice call {}/apply_force "
      "\"{{radius: 0.05, force: {{z: 0.5}}, duration: {{secs: 1}}}}\"",
      node);
  if (const std::string other = other_solver(world); !other.empty()) {
    text += fmt::format("\n             rosservice call {}/switch_solver \"{{name: {}}}\"", node,
                        other);
  }
  text += fmt::format("\n             rosservice call {}/reset", node);
  for (const std::string& line : names.replaced()) text += "\n  note       " + line;
  return text;
}

}  // namespace pliant
