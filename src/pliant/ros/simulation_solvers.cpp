#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/simulation.h"

namespace pliant {
namespace {

/// Takes the solvers of some bodies, and gives all their old ones back unless it is told to keep
/// the new ones.
class SolverRollback {
 public:
  SolverRollback(World& world, const std::vector<Body*>& bodies) : world_(world) {
    for (const Body& body : world_.bodies()) old_.push_back({body.solver, body.solver_setting});
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
    if (changed_) world_.system_changed();
  }
  void keep_new() { keep_ = true; }

 private:
  struct Old {
    std::shared_ptr<Solver> solver;
    std::pair<std::string, ParameterText> setting;
  };
  World& world_;
  std::vector<Old> old_;
  bool keep_ = false, changed_ = false;
};

/// A solver for all bodies that suits some alone is refused with the names of these.
void require_suits_all(const std::string& solver, const BodyNames& names) {
  std::vector<std::size_t> suited, others;
  const std::vector<std::string>& models = find_solver(solver).models;
  for (std::size_t b = 0; b < names.size(); ++b) {
    const bool suits = std::find(models.begin(), models.end(), names.model(b)) != models.end();
    (suits ? suited : others).push_back(b);
  }
  if (suited.empty() || others.empty()) return;
  throw InputError(fmt::format(
      "switch_solver: solver '{}' works for {}, but not for {} of the model '{}': name a 'body'",
      solver, names.text(suited), names.text({others.front()}), names.model(others.front())));
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
                                 const std::string& body) {
  const std::vector<std::size_t> meant = names_.find("switch_solver", body);
  if (body.empty()) require_suits_all(name, names_);
  std::vector<Body*> bodies;
  for (const std::size_t b : meant) bodies.push_back(&world().bodies()[b]);
  SolverRollback rollback(world(), bodies);
  for (Body* each : bodies) {
    world().set_solver({each}, all_solvers(), name, parameters, "switch_solver");
  }
  rollback.keep_new();
  return {true, fmt::format("{} for {} from {:.6g} s on", name, names_.text(meant), world().time()),
          world().time()};
}

}  // namespace pliant
