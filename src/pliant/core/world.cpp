#include "pliant/core/world.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

#include "pliant/core/columns.h"
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
  if (body.solver_dt == 0.0) body.solver_dt = dt_;
  solver->prepare(body.model->system(), body.solver_dt);
  if (body.solver && body.solver->name() == solver->name()) {
    body.learned.clear();
    body.solver->save(body.learned);
    solver->load(body.learned);
  }
  body.solver = std::move(solver);
}

void World::prepare_solver(Body& body, double dt) {
  body.solver_dt = dt;
  if (body.solver) body.solver->prepare(body.model->system(), dt);
}

void World::system_changed() {
  for (Body& body : bodies_) prepare_solver(body, body.solver_dt);
}

void World::move_obstacles(double time) {
  for (Obstacle& obstacle : obstacles_) obstacle.pose_start = obstacle.pose_end;
  for (const auto& driver : drivers_) driver->drive(time, obstacles_);
}

bool World::step() {
  begin_step();
  return finish_step();
}

void World::begin_step() {
  const double end = static_cast<double>(steps_ + 1) * dt_;
  move_obstacles(end);
  next_reactions_.assign(obstacles_.size(), Reaction());
  if (!applied_forces_.empty()) {
    std::vector<const Particles*> particles;
    for (const Body& body : bodies_) particles.push_back(&body.particles());
    applied_forces_.begin_step(time_, dt_, particles);
  }
  if (bodies_.size() == 1) begin_body(bodies_.front(), 0);
}

bool World::finish_step() {
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    Body& body = bodies_[static_cast<std::size_t>(b)];
    // Of several, each begins when those before it are done, so that undo() meets none that only
    // began.
    if (bodies_.size() > 1) begin_body(body, b);
    if (!finish_body(body, b)) {
      undo(b + 1);
      return false;
    }
  }
  ++steps_;
  time_ = static_cast<double>(steps_) * dt_;
  reactions_.swap(next_reactions_);
  applied_forces_.end_step(time_);
  if (!field_ramps_.empty()) field_ramps_.advance(bodies_, time_);
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
    if (body.parts > 1) {
      undo_parts(body);
    } else if (body.parts == 1) {
      body.model->system().undo_step();
      for (const auto& effect : body.effects) effect->undo_step();
    }
    if (body.parts == 0) continue;
    body.learned.rewind();
    body.solver->load(body.learned);
  }
  for (Obstacle& obstacle : obstacles_) obstacle.pose_end = obstacle.pose_start;
}

void World::undo_parts(Body& body) {
  body.particles() = body.before;
  body.before_numbers.rewind();
  for (const auto& effect : body.effects) {
    effect->reset(body);
    effect->load(body.before_numbers);
  }
}

void World::begin_parts(Body& body, const StepPlan& plan) {
  const double dt = dt_ / plan.parts;
  if (plan.system_changed || dt != body.solver_dt) {
    ScopedPhase phase(body.report, "prepare");
    prepare_solver(body, dt);
  }
  body.learned.clear();
  body.solver->save(body.learned);
  if (plan.parts == 1) return;
  body.before = body.particles();
  body.before_numbers.clear();
  for (const auto& effect : body.effects) effect->save(body.before_numbers);
  obstacle_steps_.clear();
  for (const Obstacle& obstacle : obstacles_) {
    obstacle_steps_.emplace_back(obstacle.pose_start, obstacle.pose_end);
  }
}

void World::place_obstacles(int part, int parts) {
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const auto& [start, end] = obstacle_steps_[o];
    const auto pose_at = [&, &from = start, &to = end](int k) -> Eigen::Isometry3d {
      if (k == 0) return from;
      if (k == parts) return to;
      const double share = static_cast<double>(k) / parts;
      const Eigen::Quaterniond turn(from.linear());
      Eigen::Isometry3d pose(turn.slerp(share, Eigen::Quaterniond(to.linear())));
      pose.translation() = (1.0 - share) * from.translation() + share * to.translation();
      return pose;
    };
    obstacles_[o].pose_start = pose_at(part);
    obstacles_[o].pose_end = pose_at(part + 1);
  }
}

void World::begin_body(Body& body, int index) {
  const Timer timer;
  body.report.begin(steps_ + 1, static_cast<double>(steps_ + 1) * dt_, dt_);
  const StepPlan plan = body.model->plan_step(dt_, body.report);
  body.parts = plan.refusal.empty() ? plan.parts : 0;
  body.report.failure = plan.refusal;
  if (body.parts == 0) return;
  begin_parts(body, plan);
  if (body.parts == 1) begin_part(body, index);
  body.report.seconds = timer.seconds();
}

bool World::finish_body(Body& body, int index) {
  if (body.parts == 0) return false;
  const Timer timer;
  bool is_finite = true;
  if (body.parts == 1) {
    is_finite = finish_part(body);
    if (is_finite) add_reactions(body);
  } else {
    is_finite = finish_parts(body, index);
  }
  body.report.seconds += timer.seconds();
  return is_finite;
}

bool World::finish_parts(Body& body, int index) {
  bool is_finite = true;
  for (int part = 0; part < body.parts && is_finite; ++part) {
    place_obstacles(part, body.parts);
    if (part > 0) body.report.begin_part();
    begin_part(body, index);
    is_finite = finish_part(body);
    if (is_finite) add_reactions(body);
  }
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    std::tie(obstacles_[o].pose_start, obstacles_[o].pose_end) = obstacle_steps_[o];
  }
  body.report.add_figure("parts", body.parts);
  return is_finite;
}

void World::begin_part(Body& body, int index) {
  const double dt = dt_ / body.parts;
  StepReport& report = body.report;
  System& system = body.model->system();
  parallel_zero(system.particles.size(), system.external_forces);
  applied_forces_.add_to(index, system.particles, system.external_forces);
  for (const auto& effect : body.effects) {
    ScopedPhase phase(report, effect->name());
    effect->before_step(body, dt);
  }
  body.model->before_solver(body, obstacles_, dt);
  body.solver->begin_step(system, dt, report);
}

bool World::finish_part(Body& body) {
  const double dt = dt_ / body.parts;
  StepReport& report = body.report;
  System& system = body.model->system();
  body.solver->finish_step(system, dt, report);
  const std::optional<int> bad = finite_check_.first_bad(body.particles());
  if (bad) {
    report.failure = finite_check_.message(body.particles(), *bad, body.name,
                                           std::string(body.solver->name()), report.time, dt_);
    return false;
  }
  body.model->after_solver(body, dt);
  for (const auto& effect : body.effects) {
    ScopedPhase phase(report, effect->name());
    effect->after_step(body, dt);
  }
  return true;
}

void World::add_reactions(const Body& body) {
  part_reactions_.assign(obstacles_.size(), Reaction());
  body.model->add_reactions(part_reactions_);
  for (const auto& effect : body.effects) effect->add_reactions(part_reactions_);
  const double share = 1.0 / body.parts;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    next_reactions_[o].force += share * part_reactions_[o].force;
    next_reactions_[o].torque += share * part_reactions_[o].torque;
  }
}

void World::reset() {
  time_ = 0.0;
  steps_ = 0;
  applied_forces_.clear();
  field_ramps_.clear();
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
