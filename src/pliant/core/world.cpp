#include "pliant/core/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {

void Body::prepare_solver(double dt) {
  if (group != nullptr) group->prepare_solver(dt);
}

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
  groups_.push_back(std::make_unique<Group>(bodies_.back()));
  return bodies_.back();
}

void World::group(std::vector<Body*> bodies, LockstepFactory make_lockstep) {
  const auto is_member = [&](const std::unique_ptr<Group>& own) {
    return std::find(bodies.begin(), bodies.end(), &own->first()) != bodies.end();
  };
  // Where the first of them stood.
  const auto first = std::find_if(groups_.begin(), groups_.end(), is_member);
  const auto place = first - groups_.begin();
  groups_.erase(std::remove_if(first, groups_.end(), is_member), groups_.end());
  groups_.insert(groups_.begin() + place,
                 std::make_unique<Group>(std::move(bodies), std::move(make_lockstep)));
}

void World::set_initial_state() {
  for (Body& body : bodies_) {
    body.initial = body.particles();
    body.model->system().first_positions = &body.initial.x;
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
  std::unique_ptr<Effect> effect = entry.make(checked, EffectSite{body, obstacles_, body_pairs_});
  if (Constraint* constraint = effect->constraint()) {
    body.model->system().constraints.push_back(constraint);
  }
  if (Constraint* constraint = effect->constraint_between_bodies()) {
    body.group->joint()->add_constraint(constraint);
  }
  body.effects.push_back(std::move(effect));
}

void World::set_solver(Body& body, const SolverRegistry& registry, const std::string& name,
                       const ParameterText& parameters, const std::string& where) {
  set_solver(body.group->bodies(), registry, name, parameters, where);
}

void World::set_solver(const std::vector<Body*>& bodies, const SolverRegistry& registry,
                       const std::string& name, const ParameterText& parameters,
                       const std::string& where) {
  Group& group = *bodies.front()->group;
  const auto& entry = registry.find(name);
  for (const Body* body : bodies) registry.find_for(name, std::string(body->model->name()));
  const Parameters checked = parse_parameters(entry.parameters, parameters, where);
  const std::pair<std::string, ParameterText> setting(name, parameters);
  std::shared_ptr<Solver> solver = entry.make(checked);
  for (Body* other : group.bodies()) {
    // What moves coordinates knows one system alone.
    if (other->model->system().as_projective() == nullptr) continue;
    const bool stays = std::find(bodies.begin(), bodies.end(), other) == bodies.end();
    if (stays && other->solver && other->solver_setting == setting) solver = other->solver;
  }
  std::vector<std::shared_ptr<Solver>> old;
  for (const Body* body : group.bodies()) old.push_back(body->solver);
  Body& first = group.first();
  const double dt = first.solver_dt == 0.0 ? dt_ : first.solver_dt;
  for (Body* body : bodies) {
    const bool shares = body == bodies.front() || body->model->system().as_projective() != nullptr;
    body->solver = shares ? solver : std::shared_ptr<Solver>(entry.make(checked));
  }
  try {
    group.prepare_solver(dt);
  } catch (...) {
    for (std::size_t b = 0; b < old.size(); ++b) group.bodies()[b]->solver = old[b];
    // The joint system may be another one than they were prepared for.
    if (group.joint() != nullptr) group.prepare_solver(dt);
    throw;
  }
  for (Body* body : bodies) body->solver_setting = setting;
  // What is learned of all of them goes on where all took another one of the same name.
  if (!old.front() || old.front()->name() != solver->name() || &group.solver() != solver.get()) {
    return;
  }
  first.learned.clear();
  old.front()->save(first.learned);
  solver->load(first.learned);
}

void World::set_time_integration(Body& body, const TimeIntegrationRegistry& registry,
                                 const std::string& name) {
  for (const Body* other : body.group->bodies()) {
    registry.find_for(name, std::string(other->model->name()));
  }
  std::shared_ptr<const TimeIntegration> integration = registry.find(name).make(Parameters());
  if (integration->is_first_order()) integration.reset();
  body.group->set_time_integration(std::move(integration));
}

void World::system_changed() {
  for (const auto& group : groups_) group->prepare_solver(group->first().solver_dt);
}

bool World::yields() const {
  return std::any_of(drivers_.begin(), drivers_.end(),
                     [](const auto& driver) { return driver->yields(); });
}

void World::move_obstacles(double time) {
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  for (const auto& driver : drivers_) driver->drive(time, obstacles_);
}

void World::reset() {
  time_ = 0.0;
  steps_ = 0;
  applied_forces_.clear();
  field_ramps_.clear();
  near_bodies_.reset();
  for (Body& body : bodies_) {
    System& system = body.model->system();
    system.particles = body.initial;
    system.reset();
    body.initial_numbers.rewind();
    system.load(body.initial_numbers);
    for (const auto& effect : body.effects) effect->reset(body);
    body.report.begin(0, 0.0, dt_);
    body.solver_dt = dt_;
  }
  move_obstacles(0.0);
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  reactions_.assign(obstacles_.size(), Reaction());
  for (const auto& group : groups_) {
    if (group->integrated() != nullptr) group->integrated()->reset();
  }
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
