#include "pliant/core/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/core/world.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

std::vector<std::string> effect_names(const Body& body) {
  std::vector<std::string> names;
  for (const auto& effect : body.effects) names.emplace_back(effect->name());
  return names;
}

Checkpoint::BodyState saved(const Body& body) {
  Checkpoint::BodyState state;
  state.name = body.name;
  state.particles = body.particles();
  state.effects = effect_names(body);
  body.model->system().save(state.numbers);
  for (const auto& effect : body.effects) effect->save(state.numbers);
  state.solver = body.solver->name();
  if (&body.group->first() == &body) body.group->solver().save(state.learned);
  state.solver_dt = body.solver_dt;
  const IntegratedStep* integrated = body.group->integrated();
  if (integrated != nullptr) state.effective_dt = integrated->effective_step();
  return state;
}

void check_fits(const Checkpoint::BodyState& state, const Body& body) {
  const bool fits = state.name == body.name && state.particles.size() == body.particles().size() &&
                    state.effects == effect_names(body);
  if (fits) return;
  throw InputError(
      fmt::format("the saved state is not of body '{}': its name, its number of vertices ({} here, "
                  "{} saved) or its effects differ; load it into the scene that saved it",
                  body.name, body.particles().size(), state.particles.size()));
}

void restore(StateArchive numbers, Body& body) {
  numbers.rewind();
  body.model->system().load(numbers);
  for (const auto& effect : body.effects) {
    effect->reset(body);
    effect->load(numbers);
  }
}

/// Whether what they learned is of solvers of the same names.
bool are_solvers_of(const Checkpoint& checkpoint, const Group& group) {
  const auto& bodies = group.bodies();
  return std::all_of(bodies.begin(), bodies.end(), [&](const Body* body) {
    return std::any_of(checkpoint.bodies.begin(), checkpoint.bodies.end(), [&](const auto& state) {
      return state.name == body->name && state.solver == body->solver->name();
    });
  });
}

}  // namespace

Checkpoint World::save() const {
  Checkpoint checkpoint;
  checkpoint.time_step = dt_;
  checkpoint.time = time_;
  checkpoint.steps = steps_;
  for (const Body& body : bodies_) checkpoint.bodies.push_back(saved(body));
  for (const Obstacle& obstacle : obstacles_) {
    checkpoint.obstacles.push_back({obstacle.pose_start, obstacle.pose_end});
  }
  for (const auto& driver : drivers_) driver->save(checkpoint.driven);
  checkpoint.applied_forces = applied_forces_;
  checkpoint.field_ramps = field_ramps_;
  return checkpoint;
}

void World::load(const Checkpoint& checkpoint) {
  if (checkpoint.bodies.size() != bodies_.size() ||
      checkpoint.obstacles.size() != obstacles_.size() || checkpoint.time_step != dt_) {
    throw InputError(fmt::format(
        "the saved state has {} bodies, {} obstacles and time step {:g} s, but the scene has {}, "
        "{} and {:g} s: load it into the scene that saved it",
        checkpoint.bodies.size(), checkpoint.obstacles.size(), checkpoint.time_step, bodies_.size(),
        obstacles_.size(), dt_));
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) check_fits(checkpoint.bodies[b], bodies_[b]);
  const Checkpoint before = save();
  try {
    take(checkpoint);
  } catch (...) {
    take(before);
    throw;
  }
}

void World::take(const Checkpoint& checkpoint) {
  time_ = checkpoint.time;
  steps_ = checkpoint.steps;
  applied_forces_ = checkpoint.applied_forces;
  field_ramps_ = checkpoint.field_ramps;
  bool changed = false;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Checkpoint::BodyState& state = checkpoint.bodies[b];
    changed |= state.particles.inverse_mass != bodies_[b].particles().inverse_mass ||
               state.particles.mass != bodies_[b].particles().mass;
    changed |= state.solver_dt != bodies_[b].solver_dt || bodies_[b].model->system_varies();
    bodies_[b].solver_dt = state.solver_dt;
    bodies_[b].particles() = state.particles;
    restore(state.numbers, bodies_[b]);
  }
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    obstacles_[o].pose_start = checkpoint.obstacles[o].start;
    obstacles_[o].pose_end = checkpoint.obstacles[o].end;
  }
  StateArchive driven = checkpoint.driven;
  for (const auto& driver : drivers_) driver->load(driven);
  reactions_.assign(obstacles_.size(), Reaction());
  if (changed) system_changed();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (&bodies_[b].group->first() != &bodies_[b]) continue;
    StateArchive learned = checkpoint.bodies[b].learned;
    IntegratedStep* integrated = bodies_[b].group->integrated();
    const double effective = checkpoint.bodies[b].effective_dt;
    if (integrated != nullptr && effective > 0.0) integrated->prepare_effective(effective);
    if (are_solvers_of(checkpoint, *bodies_[b].group)) bodies_[b].group->solver().load(learned);
  }
}

}  // namespace pliant
