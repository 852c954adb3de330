// One step of a world, group by group.
#include <algorithm>
#include <tuple>

#include "pliant/core/columns.h"
#include "pliant/core/step/impact_substeps.h"
#include "pliant/core/world.h"

namespace pliant {
namespace {
// Of a step, for what bodies press on.
constexpr int kMostTries = 5;
}  // namespace

bool World::step() {
  begin_step();
  return finish_step();
}

void World::begin_step() {
  const double end = static_cast<double>(steps_ + 1) * dt_;
  move_obstacles(end);
  next_reactions_.assign(obstacles_.size(), Reaction());
  if (!applied_forces_.empty()) {
    std::vector<ForcePoints> points;
    for (const Body& body : bodies_) points.push_back(body.force_points());
    applied_forces_.begin_step(time_, dt_, points);
  }
  begin_single_group();
}

void World::begin_single_group() {
  if (groups_.size() == 1) begin_group(*groups_.front());
}

bool World::drivers_yield(bool last) {
  bool any = false;
  for (const auto& driver : drivers_) {
    if (driver->yields() && driver->answer(next_reactions_, last, obstacles_)) any = true;
  }
  return any;
}

bool World::take_held_back() {
  bool any = false;
  for (const auto& driver : drivers_) {
    if (driver->yields() && driver->hold_back(obstacles_)) any = true;
  }
  return any && take_again();
}

bool World::take_again() {
  std::vector<double> seconds;
  for (const auto& group : groups_) seconds.push_back(group->first().report.seconds);
  next_reactions_.assign(obstacles_.size(), Reaction());
  begin_single_group();
  if (!finish_groups()) return false;
  for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g]->first().report.seconds += seconds[g];
  return true;
}

bool World::finish_step() {
  if (!finish_groups() && !take_held_back()) return false;
  for (int tries = 1; drivers_yield(tries == kMostTries); ++tries) {
    undo_groups(groups_.size());
    if (!take_again() && !take_held_back()) return false;
    for (const auto& group : groups_) group->first().report.add_metric("tries", tries + 1);
  }
  ++steps_;
  near_bodies_.look(steps_, bodies_, body_pairs_);
  time_ = static_cast<double>(steps_) * dt_;
  reactions_.swap(next_reactions_);
  applied_forces_.end_step(time_);
  if (!field_ramps_.empty()) field_ramps_.advance(bodies_, time_);
  return true;
}

bool World::finish_groups() {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    // Of several, each begins when those before it are done, so that undo() meets none that only
    // began.
    if (groups_.size() > 1) begin_group(*groups_[g]);
    if (!finish_group(*groups_[g])) {
      undo(g + 1);
      return false;
    }
  }
  return true;
}

std::string World::failure() const {
  for (const Body& body : bodies_) {
    if (!body.report.failure.empty()) return body.report.failure;
  }
  return {};
}

void World::undo(Body& body) {
  if (body.is_kept) {
    go_back(body);
  } else if (body.substeps == 1) {
    body.model->system().undo_step();
    for (const auto& effect : body.effects) effect->undo_step();
  }
}

void World::undo(std::size_t stepped_groups) {
  undo_groups(stepped_groups);
  for (Obstacle& obstacle : obstacles_) obstacle.pose_end = obstacle.pose_start;
}

void World::undo_groups(std::size_t stepped_groups) {
  for (std::size_t g = 0; g < stepped_groups; ++g) {
    for (Body* body : groups_[g]->bodies()) undo(*body);
    Body& first = groups_[g]->first();
    if (first.substeps == 0) continue;
    first.learned.rewind();
    groups_[g]->solver().load(first.learned);
  }
}

bool World::keeps(const Body& body) const {
  // A single body's step fails before its effects' after_step().
  return (bodies_.size() > 1 || yields()) &&
         std::any_of(body.effects.begin(), body.effects.end(),
                     [](const auto& effect) { return effect->remembers_steps(); });
}

void World::keep(Body& body) {
  body.before = body.particles();
  body.before_numbers.clear();
  body.model->system().save(body.before_numbers);
  for (const auto& effect : body.effects) effect->save(body.before_numbers);
}

void World::go_back(Body& body) {
  body.particles() = body.before;
  body.before_numbers.rewind();
  body.model->system().load(body.before_numbers);
  for (const auto& effect : body.effects) {
    effect->reset(body);
    effect->load(body.before_numbers);
  }
}

void World::prepare_group(Group& group, double dt) {
  ScopedPhase phase(group.first().report, "prepare");
  group.prepare_solver(dt);
}

void World::begin_substeps(Group& group, int substeps) {
  Body& first = group.first();
  const double dt = dt_ / substeps;
  if (dt != first.solver_dt) prepare_group(group, dt);
  first.learned.clear();
  group.solver().save(first.learned);
  for (Body* body : group.bodies()) {
    body->is_kept = substeps > 1 || keeps(*body);
    if (body->is_kept) keep(*body);
  }
  if (substeps == 1) return;
  obstacle_steps_.clear();
  for (const Obstacle& obstacle : obstacles_) {
    obstacle_steps_.emplace_back(obstacle.pose_start, obstacle.pose_end);
  }
}

void World::place_obstacles(int substep, int substeps) {
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const auto& [start, end] = obstacle_steps_[o];
    const auto pose_at = [&, &from = start, &to = end](int k) -> Eigen::Isometry3d {
      if (k == 0) return from;
      if (k == substeps) return to;
      const double share = static_cast<double>(k) / substeps;
      const Eigen::Quaterniond turn(from.linear());
      Eigen::Isometry3d pose(turn.slerp(share, Eigen::Quaterniond(to.linear())));
      pose.translation() = (1.0 - share) * from.translation() + share * to.translation();
      return pose;
    };
    obstacles_[o].pose_start = pose_at(substep);
    obstacles_[o].pose_end = pose_at(substep + 1);
  }
}

void World::begin_group(Group& group) {
  const Timer timer;
  int substeps = 1;
  bool system_changed = false, is_refused = false;
  for (Body* body : group.bodies()) {
    body->is_kept = false;
    body->report.begin(steps_ + 1, static_cast<double>(steps_ + 1) * dt_, dt_);
    for (const auto& effect : body->effects) {
      ScopedPhase phase(body->report, effect->name());
      effect->change_elements(*body, dt_);
    }
    StepPlan plan = body->model->plan_step(dt_, body->report);
    substeps = std::max(substeps, plan.substeps);
    system_changed = system_changed || plan.system_changed;
    is_refused = is_refused || !plan.refusal.empty();
    body->report.failure = std::move(plan.refusal);
  }
  substeps = std::max(substeps, substeps_after_impact(group, dt_));
  if (!is_refused) {
    if (system_changed) prepare_group(group, dt_ / substeps);
    substeps = std::max(substeps, group.solver().substeps_of_step(dt_));
  }
  for (Body* body : group.bodies()) body->substeps = is_refused ? 0 : substeps;
  if (is_refused) return;
  begin_substeps(group, substeps);
  if (substeps == 1) begin_substep(group);
  group.first().report.seconds = timer.seconds();
}

bool World::finish_group(Group& group) {
  Body& first = group.first();
  if (first.substeps == 0) return false;
  const Timer timer;
  bool is_finite = true;
  if (first.substeps == 1) {
    group.finish_step(dt_);
    const int substeps = substeps_for_impact(group, dt_);
    if (substeps > 1) {
      take_back(group);
      for (Body* body : group.bodies()) body->substeps = substeps;
      begin_substeps(group, substeps);
    }
  }
  if (first.substeps == 1) {
    is_finite = std::all_of(group.bodies().begin(), group.bodies().end(),
                            [&](Body* body) { return end_solved(*body, dt_); });
    if (is_finite) add_reactions(group);
  } else {
    is_finite = finish_substeps(group);
  }
  first.report.seconds += timer.seconds();
  return is_finite;
}

bool World::finish_substeps(Group& group) {
  const int substeps = group.first().substeps;
  bool is_finite = true;
  for (int substep = 0; substep < substeps && is_finite; ++substep) {
    place_obstacles(substep, substeps);
    for (Body* body : group.bodies()) {
      if (substep > 0) body->report.begin_substep();
    }
    begin_substep(group);
    is_finite = finish_substep(group);
    if (is_finite) add_reactions(group);
  }
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    std::tie(obstacles_[o].pose_start, obstacles_[o].pose_end) = obstacle_steps_[o];
  }
  group.first().report.add_metric("substeps", substeps);
  return is_finite;
}

int World::index_of(const Body& body) const {
  const auto found =
      std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& own) { return &own == &body; });
  return static_cast<int>(found - bodies_.begin());
}

void World::begin_substep(Group& group) {
  Body& first = group.first();
  const double dt = dt_ / first.substeps;
  for (Body* body : group.bodies()) {
    System& system = body->model->system();
    parallel_zero(system.particles.size(), system.external_forces);
    applied_forces_.add_to(index_of(*body), body->force_points(), system.external_forces);
    for (const auto& effect : body->effects) {
      ScopedPhase phase(body->report, effect->name());
      effect->before_step(*body, dt);
    }
    body->model->before_solver(*body, obstacles_, dt);
  }
  group.begin_step(dt);
}

bool World::finish_substep(Group& group) {
  Body& first = group.first();
  const double dt = dt_ / first.substeps;
  group.finish_step(dt);
  for (Body* body : group.bodies()) {
    if (!end_solved(*body, dt)) return false;
  }
  return true;
}

bool World::end_solved(Body& body, double dt) {
  StepReport& report = body.report;
  if (!report.failure.empty()) return false;  // a constraint says why
  const std::optional<int> bad = finite_check_.first_bad(body.particles());
  if (bad) {
    report.failure = finite_check_.message(body.particles(), *bad, body.name,
                                           std::string(body.solver->name()), report.time, dt_);
    return false;
  }
  body.model->after_solver(body, dt);
  if (body.group->integrated() != nullptr) body.group->integrated()->remember(body);
  for (const auto& effect : body.effects) {
    ScopedPhase phase(report, effect->name());
    effect->after_step(body, dt);
  }
  return true;
}

void World::add_reactions(const Group& group) {
  substep_reactions_.assign(obstacles_.size(), Reaction());
  for (const Body* body : group.bodies()) {
    body->model->add_reactions(substep_reactions_);
    for (const auto& effect : body->effects) effect->add_reactions(substep_reactions_);
  }
  const double share = 1.0 / group.first().substeps;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    next_reactions_[o].force += share * substep_reactions_[o].force;
    next_reactions_[o].torque += share * substep_reactions_[o].torque;
    if (substep_reactions_[o].overlap.depth > next_reactions_[o].overlap.depth) {
      next_reactions_[o].overlap = substep_reactions_[o].overlap;
    }
  }
}

}  // namespace pliant
