#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pliant/core/step/body_integration.h"
#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/running/simulation.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

/// Takes the solvers of some bodies where they shall have others, and gives all their old ones and
/// their time integrations back unless it is told to keep the new ones.
class SolverRollback {
 public:
  SolverRollback(World& world, const std::vector<Body*>& bodies, bool takes) : world_(world) {
    for (const Body& body : world_.bodies()) {
      old_.push_back(
          {body.solver, body.solver_setting, time_integration_of(body), body.particles().history});
    }
    if (!takes) return;
    for (Body* body : bodies) body->solver = nullptr;
  }
  ~SolverRollback() {
    if (keep_) return;
    for (std::size_t b = 0; b < old_.size(); ++b) {
      Body& body = world_.bodies()[b];
      // What was prepared for others has to be so anew.
      changed_ = changed_ || (body.solver != nullptr && body.solver != old_[b].solver);
      body.solver = old_[b].solver;
      body.solver_setting = old_[b].setting;
    }
    give_integrations_back();
    if (changed_) world_.system_changed();
  }
  void keep_new() { keep_ = true; }

 private:
  struct Old {
    std::shared_ptr<Solver> solver;
    std::pair<std::string, ParameterText> setting;
    std::string_view integration;
    MotionHistory history;
  };

  void give_integrations_back() {
    for (std::size_t b = 0; b < old_.size(); ++b) {
      Body& body = world_.bodies()[b];
      const std::string_view old = old_[b].integration;
      if (time_integration_of(body) != old) {
        world_.set_time_integration(body, time_integrations(), std::string(old));
      }
      body.particles().history = old_[b].history;
    }
  }

  World& world_;
  std::vector<Old> old_;
  bool keep_ = false, changed_ = false;
};

/// A body that the default solver of all that touch moves, and its own default where one of them
/// has another solver.
struct MovedByDefault {
  Body* body;
  DefaultSolver beside_others;
};

/// Those beside the `meant` bodies that newton moves by default together with them.
std::vector<MovedByDefault> moved_by_default(World& world, const std::vector<Body*>& meant) {
  std::vector<MovedByDefault> all;
  for (Body& body : world.bodies()) {
    const auto touches = [&](const Body* other) { return other->group == body.group; };
    if (std::find(meant.begin(), meant.end(), &body) != meant.end() ||
        std::none_of(meant.begin(), meant.end(), touches)) {
      continue;
    }
    std::vector<std::string> models;
    for (const Body* other : body.group->bodies()) models.emplace_back(other->model->name());
    const std::string model(body.model->name());
    const DefaultSolver as_one = default_solver_among(model, models, true);
    DefaultSolver beside_others = default_solver_among(model, models, false);
    const std::pair<std::string, ParameterText> setting(as_one.name, as_one.parameters);
    if (as_one.name == beside_others.name || body.solver_setting != setting) continue;
    all.push_back({&body, std::move(beside_others)});
  }
  return all;
}

/// What some bodies shall have; a name that is empty leaves what they have.
struct Wish {
  const std::vector<Body*>& bodies;
  const std::string& solver;
  const ParameterText& parameters;
  const std::string& time_integration;
};

/// Gives the bodies what is wished for, and others what they have beside that. All keep what they
/// have where that is refused.
void take(World& world, const Wish& wish, const std::vector<MovedByDefault>& others) {
  std::vector<Body*> changed = wish.bodies;
  for (const MovedByDefault& other : others) changed.push_back(other.body);
  SolverRollback rollback(world, changed, !wish.solver.empty());
  const auto integrate = [&] {
    for (Body* each : wish.bodies) {
      world.set_time_integration(*each, time_integrations(), wish.time_integration);
    }
  };
  // A solver with an integration of its own goes with no other one.
  const bool is_first = wish.time_integration == kImplicitEuler;
  if (is_first) integrate();
  for (const auto& [other, solver] : others) {
    world.set_solver({other}, all_solvers(), solver.name, solver.parameters, "switch_solver");
  }
  for (Body* each : wish.bodies) {
    if (wish.solver.empty()) break;
    world.set_solver({each}, all_solvers(), wish.solver, wish.parameters, "switch_solver");
  }
  if (!is_first && !wish.time_integration.empty()) integrate();
  rollback.keep_new();
}

/// A solver for all bodies that suits some alone is refused with the names of these.
void require_suits_all(const std::string& kind, const std::string& name,
                       const std::vector<std::string>& models, const BodyNames& names) {
  std::vector<std::size_t> suited, others;
  for (std::size_t b = 0; b < names.size(); ++b) {
    const bool suits = std::find(models.begin(), models.end(), names.model(b)) != models.end();
    (suits ? suited : others).push_back(b);
  }
  if (suited.empty() || others.empty()) return;
  throw InputError(fmt::format(
      "switch_solver: {} '{}' works for {}, but not for {} of the model '{}': name a 'body'", kind,
      name, names.text(suited), names.text({others.front()}), names.model(others.front())));
}

}  // namespace

std::string Simulation::solvers() const {
  std::vector<std::string_view> all;
  for (const Body& body : world().bodies()) {
    const std::string_view own = body.solver->name();
    if (std::find(all.begin(), all.end(), own) == all.end()) all.push_back(own);
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

Answer Simulation::switch_solver(const std::string& name, const ParameterText& parameters,
                                 const std::string& body, const std::string& time_integration) {
  const std::vector<std::size_t> meant = names_.find("switch_solver", body);
  if (body.empty() && !name.empty()) {
    require_suits_all("solver", name, find_solver(name).models, names_);
  }
  if (body.empty() && !time_integration.empty()) {
    require_suits_all("time_integration", time_integration,
                      time_integrations().find(time_integration).models, names_);
  }
  std::vector<Body*> bodies;
  for (const std::size_t b : meant) bodies.push_back(&world().bodies()[b]);
  const Wish wish = {bodies, name, parameters, time_integration};
  std::string beside;
  try {
    take(world(), wish, {});
  } catch (const InputError&) {
    // What nobody chose for the others gives way.
    const std::vector<MovedByDefault> others =
        name.empty() ? std::vector<MovedByDefault>() : moved_by_default(world(), bodies);
    if (others.empty()) throw;
    take(world(), wish, others);
    for (const auto& [other, solver] : others) {
      beside += fmt::format("; '{}' takes {} beside it", other->name, solver.name);
    }
  }
  const char* const both = name.empty() || time_integration.empty() ? "" : " by ";
  return {true,
          fmt::format("{}{}{} for {} from {:.6g} s on{}", name, both, time_integration,
                      names_.text(meant), world().time(), beside),
          world().time()};
}

}  // namespace pliant
