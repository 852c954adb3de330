#include "pliant/core/world.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/math/error.h"

namespace pliant {

Effect* Body::find_effect(std::string_view effect_name) const {
  for (const auto& effect : effects) {
    if (effect->name() == effect_name) return effect.get();
  }
  return nullptr;
}

World::World(double time_step) : dt_(time_step) {
  if (!(std::isfinite(dt_) && dt_ > 0.0)) {
    throw InputError(fmt::format("time step is {} s, but must be positive and finite", dt_));
  }
}

void World::add_driver(std::unique_ptr<ObstacleDriver> driver) {
  driver->drive(time_, obstacles_);
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  drivers_.push_back(std::move(driver));
}

Body& World::add_body(std::string name, std::unique_ptr<Model> model) {
  Body body;
  body.name = std::move(name);
  body.model = std::move(model);
  bodies_.push_back(std::move(body));
  return bodies_.back();
}

void World::set_initial_state() {
  for (Body& body : bodies_) {
    body.initial = body.particles();
    body.initial_numbers.clear();
    body.model->system().save(body.initial_numbers);
  }
  reactions_.assign(obstacles_.size(), Reaction());
}

void World::add_effect(Body& body, const EffectRegistry& registry, const std::string& name,
                       const ParameterText& parameters, const std::string& where) {
  const auto& entry = registry.find_for(name, std::string(body.model->name()));
  if (body.find_effect(name) != nullptr) {
    throw InputError(where + ": effect '" + name + "' is there already");
  }
  const Parameters checked = parse_parameters(entry.parameters, parameters, where);
  std::unique_ptr<Effect> effect = entry.make(checked, EffectSite{body, obstacles_});
  if (Coupling* coupling = effect->coupling()) {
    body.model->system().couplings.push_back(coupling);
  }
  body.effects.push_back(std::move(effect));
}

void World::set_solver(Body& body, const SolverRegistry& registry, const std::string& name,
                       const ParameterText& parameters, const std::string& where) {
  const auto& entry = registry.find_for(name, std::string(body.model->name()));
  std::unique_ptr<Solver> solver =
      entry.make(parse_parameters(entry.parameters, parameters, where));
  solver->prepare(body.model->system(), dt_);
  if (body.solver && body.solver->name() == solver->name()) {
    body.learned.clear();
    body.solver->save(body.learned);
    solver->load(body.learned);
  }
  body.solver = std::move(solver);
}

void World::system_changed() {
  for (Body& body : bodies_) {
    if (body.solver) body.solver->prepare(body.model->system(), dt_);
  }
}

void World::move_obstacles(double time) {
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  for (const auto& driver : drivers_) driver->drive(time, obstacles_);
}

bool World::step() {
  const double end = static_cast<double>(steps_ + 1) * dt_;
  move_obstacles(end);
  if (!applied_forces_.empty()) {
    std::vector<const Particles*> particles;
    for (const Body& body : bodies_) particles.push_back(&body.particles());
    applied_forces_.begin_step(time_, dt_, particles);
  }
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    Body& body = bodies_[static_cast<std::size_t>(b)];
    body.report.begin(steps_ + 1, end, dt_);
    if (!step_body(body, b)) {
      undo(b + 1);
      return false;
    }
  }
  time_ = end;
  ++steps_;
  collect_reactions();
  applied_forces_.end_step(time_);
  return true;
}

std::string World::failure() const {
  for (const Body& body : bodies_) {
    if (!body.report.failure.empty()) return body.report.failure;
  }
  return {};
}

void World::undo(int stepped_bodies) {
  for (int b = 0; b < stepped_bodies; ++b) {
    Body& body = bodies_[static_cast<std::size_t>(b)];
    body.model->system().undo_step();
    body.learned.rewind();
    body.solver->load(body.learned);
  }
  for (Obstacle& obstacle : obstacles_) obstacle.pose_end = obstacle.pose_start;
}

bool World::step_body(Body& body, int index) {
  const Timer timer;
  StepReport& report = body.report;
  System& system = body.model->system();
  system.external_forces.setZero(3, system.particles.size());
  applied_forces_.add_to(index, system.particles, system.external_forces);
  for (const auto& effect : body.effects) {
    ScopedPhase phase(report, effect->name());
    effect->before_step(body, dt_);
  }
  body.learned.clear();
  body.solver->save(body.learned);
  body.solver->step(system, dt_, report);
  const std::optional<int> bad = finite_check_.first_bad(body.particles());
  if (bad) {
    report.failure = finite_check_.message(body.particles(), *bad, body.name,
                                           std::string(body.solver->name()), report.time, dt_);
    return false;
  }
  for (const auto& effect : body.effects) {
    ScopedPhase phase(report, effect->name());
    effect->after_step(body, dt_);
  }
  report.seconds = timer.seconds();
  return true;
}

void World::collect_reactions() {
  reactions_.assign(obstacles_.size(), Reaction());
  for (const Body& body : bodies_) {
    for (const auto& effect : body.effects) effect->add_reactions(reactions_);
  }
}

void World::reset() {
  time_ = 0.0;
  steps_ = 0;
  applied_forces_.clear();
  for (Body& body : bodies_) {
    System& system = body.model->system();
    system.particles = body.initial;
    system.reset();
    body.initial_numbers.rewind();
    system.load(body.initial_numbers);
    for (const auto& effect : body.effects) effect->reset(body);
    body.report.begin(0, 0.0, dt_);
  }
  move_obstacles(0.0);
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  reactions_.assign(obstacles_.size(), Reaction());
  system_changed();
}

Energies World::energies() const {
  Energies energies;
  for (const Body& body : bodies_) {
    energies.kinetic += body.model->system().kinetic_energy();
    energies.elastic += body.model->system().elastic_energy();
    for (const auto& effect : body.effects) energies.potential += effect->potential_energy(body);
  }
  return energies;
}

}  // namespace pliant
