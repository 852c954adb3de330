#pragma once

#include "cuda/solvers/scenes/device_solver.h"

/// Steps of a DeviceSolver between which its body stays on the device.
namespace pliant {

/// Squared, in numbers that a kernel can compare [quanta²].
inline float longest_way(double quanta) {
  constexpr double kMost = 1e19;  // beyond what positions in range allow
  return static_cast<float>(std::min(kMost, quanta * quanta));
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_of(
    const Extent& extent, double fastest, const StepSeries& series) {
  const double time = series.steps * series.step_time;
  return {extent, time * (fastest + time * series.acceleration.cwiseAbs().maxCoeff())};
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_of(
    const Particles& particles, const StepSeries& series) {
  return travel_of(extent_of(particles.x, particles.x), largest_coordinate(particles.v), series);
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_from_end(
    const Particles& particles, const StepSeries& series) const {
  if (scene_->brought >= Wanted::kMotion) return travel_of(particles, series);
  const SeriesExtent& seen = scene_->extent;
  const Extent extent = {place_of(seen.low[0], seen.low[1], seen.low[2]),
                         place_of(seen.high[0], seen.high[1], seen.high[2]), 0.0};
  return travel_of(extent, quantum_ / series_dt_ * seen.fastest, series);
}

template <class Executor>
bool DeviceSolver<Executor>::takes(const ProjectiveSystem& system, const StepSeries& series,
                                   const Travel& travel) const {
  // In sizes of the body: the farther it goes, the coarser are its quanta.
  constexpr double kFarthest = 2.0;
  if (!(travel.way <= kFarthest * travel.extent.reach())) return false;
  // Positions in range are no farther than twice the reach along each axis.
  if (travel.center().norm() + std::sqrt(12.0) * travel.reach() > series.max_distance) return false;
  return !series.particles || forces_->can_take(system, series, kQuantum * travel.reach());
}

template <class Executor>
int DeviceSolver<Executor>::series_limit(const System& base, const StepSeries& series) {
  // While no recurrence can be planned, it is looked for often.
  constexpr int kMostUnestimated = 8;
  const auto& system = static_cast<const ProjectiveSystem&>(base);
  if (spec_.rule.iterations == 0 || !can_stay_on_device(system, series)) return 0;
  // Those that are under way already.
  if (follows(series)) return series.steps;
  if (scene_->brought != Wanted::kState) return 0;
  if (series.particles) {
    if (!make_forces_ || batch_ != nullptr) return 0;
    if (!forces_) forces_ = make_forces_();
  }
  StepSeries some = series;
  if (!scene_->is_estimated) some.steps = std::min(some.steps, kMostUnestimated);
  for (; some.steps >= 2; some.steps /= 2) {
    if (takes(system, some, travel_of(system.particles, some))) break;
  }
  return some.steps;
}

template <class Executor>
void DeviceSolver<Executor>::begin_forces(const ProjectiveSystem& system, const StepSeries& series,
                                          const Travel& travel) {
  if (batch_ != nullptr) return;
  scenes_->set_forces(series.particles ? forces_ : nullptr);
  if (!series.particles) return;
  const Eigen::Vector3d extent = travel.extent.high - travel.extent.low;
  forces_->begin(system, series, scene_->packed, {center_, extent, quantum_});
}

template <class Executor>
void DeviceSolver<Executor>::begin_series(System& base, const StepSeries& series,
                                          StepReport& report) {
  const ScopedPhase phase(report, "upload");
  const auto& system = static_cast<const ProjectiveSystem&>(base);
  const Particles& particles = system.particles;
  report.solver = name();
  scene_->series_steps = series.steps;
  scene_->is_due = true;
  scene_->wanted = batch_ != nullptr || series.particles ? Wanted::kState : series.wanted;
  scene_->surface = series.surface;
  if (follows(series)) return plan_following(particles, series);
  scenes_->forget_following();
  follow_shapes(system);
  const Travel travel = travel_of(particles, series);
  center_ = travel.center();
  series_dt_ = series.dt;
  set_quantum(travel.reach());
  DeviceScene& scene = *scene_;
  scene.series_parts = series.parts;
  scene.contacts.contacts.clear();
  const double in_quanta = series.dt / quantum_;
  const auto single = [](const Eigen::Vector3d& way) {
    return Float4{static_cast<float>(way[0]), static_cast<float>(way[1]),
                  static_cast<float>(way[2]), 0.0f};
  };
  const std::vector<int>& order = scene.packed.order;
  scene.now.resize(order.size());
  scene.way.resize(order.size());
  scene.way_before.resize(order.size());
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      scene.now[at] = fixed(particles.x.col(i) - center_, inertia_[i]);
      scene.way[at] = single(in_quanta * particles.v.col(i));
      scene.way_before[at] = single(in_quanta * particles.v_start.col(i));
    }
  });
  const SeriesContact contact = series_contact(system, series, center_);
  scene.obstacles = contact.obstacles;
  scene.shapes = contact.shapes;
  obstacles_ = contact.numbers;
  scene.series_rules = {};
  scene.series_rules.fall = single(in_quanta * series.dt * series.acceleration).xyz();
  scene.series_rules.velocity_loss = static_cast<float>(1.0 - series.velocity_factor);
  scene.series_rules.most_way = longest_way(in_quanta * series.max_speed);
  scene.series_rules.contact = contact.rules;
  set_anchors(system, center_);
  begin_forces(system, series, travel);
  plan_following(particles, series);
}

template <class Executor>
bool DeviceSolver<Executor>::follows(const StepSeries& series) const {
  return batch_ == nullptr && series.continues && scenes_->following() == series.steps;
}

template <class Executor>
void DeviceSolver<Executor>::plan_following(const Particles& particles, const StepSeries& series) {
  scene_->series_follow = 0;
  if (series.follow < 2 || batch_ != nullptr || series.particles) return;
  StepSeries both = series;
  both.steps += series.follow;
  const Travel travel = travel_from_end(particles, both);
  const Eigen::Array3d low = travel.extent.low - center_.array(),
                       high = travel.extent.high - center_.array();
  const double farthest = std::max(-low.minCoeff(), high.maxCoeff()) + travel.way;
  // In whole quanta; farther than twice the reach no position may go (EndStep).
  constexpr double kFarthest = 1.5 * (1 << 28);
  if (farthest <= kFarthest * quantum_) scene_->series_follow = series.follow;
}

template <class Executor>
int DeviceSolver<Executor>::finish_series(System& base, std::vector<Reaction>& reactions,
                                          StepReport& report) {
  auto& system = static_cast<ProjectiveSystem&>(base);
  report.backend = "cuda";
  if (batch_ == nullptr) {
    const ScopedPhase phase(report, "iterations");
    scenes_->run();
  } else if (!batch_->failure().empty()) {
    throw DeviceFailure(batch_->failure());
  }
  if (scene_->tally.failed != 0) return 0;
  const ScopedPhase phase(report, "download");
  if (scene_->brought >= Wanted::kMotion) take_series(system.particles);
  if (scene_->brought == Wanted::kState) take_rest(system.particles);
  if (scene_->brought == Wanted::kSurface) take_surface(system.particles);
  forget_contacts(system);
  add_reactions(reactions);
  StepControl& control = scene_->control;
  control.damped = scene_->tally.damped;
  control.lowered = scene_->tally.lowered;
  if (control.lowered != 0) control.radius = scene_->tally.radius;
  report.contacts = static_cast<int>(control.active);
  tell(report);
  if (scene_->tally.lost != 0) StepEnergy::warn(report);
  if (scene_->tally.unbalanced != 0) {
    report.warn(
        "contact_unbalanced: no contact forces were found that balance a body that nothing holds: "
        "its motion and the forces on what it touches are off; take more iterations, a smaller "
        "time step, or backend cpu");
  }
  return scene_->taken;
}

template <class Executor>
bool DeviceSolver<Executor>::bring_state(System& base) {
  if (scene_->brought == Wanted::kState) return true;
  scenes_->bring_state();
  take_series(base.particles);
  take_rest(base.particles);
  return true;
}

template <class Executor>
void DeviceSolver<Executor>::take_series(Particles& particles) {
  const std::vector<int>& order = scene_->packed.order;
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      if (particles.is_fixed(i)) continue;
      const Fixed& x = scene_->now[at];
      const Float4& way = scene_->way[at];
      particles.x.col(i) = place_of(x.x, x.y, x.z);
      particles.v.col(i) = quantum_ / series_dt_ * Eigen::Vector3d(way.x, way.y, way.z);
    }
  });
}

template <class Executor>
void DeviceSolver<Executor>::take_rest(Particles& particles) {
  const std::vector<int>& order = scene_->packed.order;
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      if (particles.is_fixed(i)) {
        particles.x_start.col(i) = particles.x.col(i);
        particles.v_start.col(i) = particles.v.col(i);
        continue;
      }
      const Fixed& x = scene_->was[at];
      const Float4& way = scene_->way_before[at];
      particles.x_start.col(i) = place_of(x.x, x.y, x.z);
      particles.v_start.col(i) = quantum_ / series_dt_ * Eigen::Vector3d(way.x, way.y, way.z);
    }
  });
}

template <class Executor>
void DeviceSolver<Executor>::take_surface(const Particles& particles) {
  const auto& points = scenes_->seen_surface();
  const int count = static_cast<int>(points.size());
  seen_surface_.resize(3, count);
  const bool are_particles = scene_->surface == nullptr;
  parallel_for(0, count, kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Quanta3& x = points[static_cast<std::size_t>(i)];
      seen_surface_.col(i) = place_of(x.x, x.y, x.z);
      // A fixed one is where it was put, between quanta.
      if (are_particles && particles.is_fixed(i)) seen_surface_.col(i) = particles.x.col(i);
    }
  });
}

template <class Executor>
void DeviceSolver<Executor>::add_reactions(std::vector<Reaction>& reactions) const {
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const double* numbers = scene_->reactions.data() + kReactionNumbers * k;
    Reaction& reaction = reactions[static_cast<std::size_t>(obstacles_[k])];
    reaction.force += Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    reaction.torque += Eigen::Vector3d(numbers[3], numbers[4], numbers[5]);
  }
}

}  // namespace pliant
