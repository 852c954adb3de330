#pragma once

#include "cuda/solvers/scenes/device_solver.h"

/// Steps of a DeviceSolver between which its body stays on the device.
namespace pliant {

/// Squared, in numbers that a kernel can compare [quanta²].
inline float longest_displacement(double quanta) {
  constexpr double kMost = 1e19;  // beyond what positions in range allow
  return static_cast<float>(std::min(kMost, quanta * quanta));
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_of(const Extent& extent,
                                                                          double fastest,
                                                                          const ResidentRun& run) {
  const double time = run.steps * run.step_time;
  return {extent, time * (fastest + time * run.acceleration.cwiseAbs().maxCoeff())};
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_of(
    const Particles& particles, const ResidentRun& run) {
  return travel_of(extent_of(particles.x, particles.x), largest_coordinate(particles.v), run);
}

template <class Executor>
typename DeviceSolver<Executor>::Travel DeviceSolver<Executor>::travel_from_end(
    const Particles& particles, const ResidentRun& run) const {
  if (scene_->available >= Readback::kMotion) return travel_of(particles, run);
  const ResidentExtent& seen = scene_->extent;
  const Extent extent = {place_of(seen.low[0], seen.low[1], seen.low[2]),
                         place_of(seen.high[0], seen.high[1], seen.high[2]), 0.0};
  return travel_of(extent, quantum_ / resident_dt_ * seen.fastest, run);
}

template <class Executor>
bool DeviceSolver<Executor>::takes(const ProjectiveSystem& system, const ResidentRun& run,
                                   const Travel& travel) const {
  // In sizes of the body: the farther it goes, the coarser are its quanta.
  constexpr double kFarthest = 2.0;
  if (!(travel.distance <= kFarthest * travel.extent.reach())) return false;
  // Positions in range are no farther than twice the reach along each axis.
  if (travel.center().norm() + std::sqrt(12.0) * travel.reach() > run.max_distance) return false;
  return !run.particles || forces_->can_take(system, run, kQuantum * travel.reach());
}

template <class Executor>
int DeviceSolver<Executor>::resident_limit(const System& base, const ResidentRun& run) {
  // While no recurrence can be planned, it is looked for often.
  constexpr int kMostUnestimated = 8;
  const auto& system = static_cast<const ProjectiveSystem&>(base);
  if (spec_.rule.iterations == 0 || !can_stay_on_device(system, run)) return 0;
  // Those that are under way already.
  if (follows(run)) return run.steps;
  if (scene_->available != Readback::kState) return 0;
  if (run.particles) {
    if (!make_forces_ || batch_ != nullptr) return 0;
    if (!forces_) forces_ = make_forces_();
  }
  ResidentRun some = run;
  if (!scene_->is_estimated) some.steps = std::min(some.steps, kMostUnestimated);
  for (; some.steps >= 2; some.steps /= 2) {
    if (takes(system, some, travel_of(system.particles, some))) break;
  }
  return some.steps;
}

template <class Executor>
void DeviceSolver<Executor>::begin_forces(const ProjectiveSystem& system, const ResidentRun& run,
                                          const Travel& travel) {
  if (batch_ != nullptr) return;
  scenes_->set_forces(run.particles ? forces_ : nullptr);
  if (!run.particles) return;
  const Eigen::Vector3d extent = travel.extent.high - travel.extent.low;
  forces_->begin(system, run, scene_->packed, {center_, extent, quantum_});
}

template <class Executor>
void DeviceSolver<Executor>::begin_resident_run(System& base, const ResidentRun& run,
                                                StepReport& report) {
  const ScopedPhase phase(report, "upload");
  const auto& system = static_cast<const ProjectiveSystem&>(base);
  const Particles& particles = system.particles;
  report.solver = name();
  scene_->resident_steps = run.steps;
  scene_->is_due = true;
  scene_->readback = batch_ != nullptr || run.particles ? Readback::kState : run.readback;
  scene_->surface = run.surface;
  if (follows(run)) return plan_following(particles, run);
  scenes_->forget_following();
  follow_shapes(system);
  const Travel travel = travel_of(particles, run);
  center_ = travel.center();
  resident_dt_ = run.dt;
  set_quantum(travel.reach());
  DeviceScene& scene = *scene_;
  scene.resident_substeps = run.substeps;
  scene.contacts.contacts.clear();
  const double in_quanta = run.dt / quantum_;
  const auto single = [](const Eigen::Vector3d& vector) {
    return Float4{static_cast<float>(vector[0]), static_cast<float>(vector[1]),
                  static_cast<float>(vector[2]), 0.0f};
  };
  const std::vector<int>& order = scene.packed.order;
  scene.now.resize(order.size());
  scene.velocity.resize(order.size());
  scene.velocity_before.resize(order.size());
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      scene.now[at] = fixed(particles.x.col(i) - center_, inertia_[i]);
      scene.velocity[at] = single(in_quanta * particles.v.col(i));
      scene.velocity_before[at] = single(in_quanta * particles.v_start.col(i));
    }
  });
  const ResidentContact contact = resident_contact(system, run, center_);
  scene.obstacles = contact.obstacles;
  scene.shapes = contact.shapes;
  obstacles_ = contact.numbers;
  scene.resident_rules = {};
  scene.resident_rules.fall = single(in_quanta * run.dt * run.acceleration).xyz();
  scene.resident_rules.velocity_loss = static_cast<float>(1.0 - run.velocity_factor);
  scene.resident_rules.most_displacement = longest_displacement(in_quanta * run.max_speed);
  scene.resident_rules.contact = contact.rules;
  set_anchors(system, center_);
  begin_forces(system, run, travel);
  plan_following(particles, run);
}

template <class Executor>
bool DeviceSolver<Executor>::follows(const ResidentRun& run) const {
  return batch_ == nullptr && run.continues && scenes_->following() == run.steps;
}

template <class Executor>
void DeviceSolver<Executor>::plan_following(const Particles& particles, const ResidentRun& run) {
  scene_->resident_follow = 0;
  if (run.follow < 2 || batch_ != nullptr || run.particles) return;
  ResidentRun both = run;
  both.steps += run.follow;
  const Travel travel = travel_from_end(particles, both);
  const Eigen::Array3d low = travel.extent.low - center_.array(),
                       high = travel.extent.high - center_.array();
  const double farthest = std::max(-low.minCoeff(), high.maxCoeff()) + travel.distance;
  // In whole quanta; farther than twice the reach no position may go (EndStep).
  constexpr double kFarthest = 1.5 * (1 << 28);
  if (farthest <= kFarthest * quantum_) scene_->resident_follow = run.follow;
}

template <class Executor>
int DeviceSolver<Executor>::finish_resident_run(System& base, std::vector<Reaction>& reactions,
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
  if (scene_->available >= Readback::kMotion) take_motion(system.particles);
  if (scene_->available == Readback::kState) take_rest(system.particles);
  if (scene_->available == Readback::kSurface) take_surface(system.particles);
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
bool DeviceSolver<Executor>::read_back_state(System& base) {
  if (scene_->available == Readback::kState) return true;
  scenes_->read_back_state();
  take_motion(base.particles);
  take_rest(base.particles);
  return true;
}

template <class Executor>
void DeviceSolver<Executor>::take_motion(Particles& particles) {
  const std::vector<int>& order = scene_->packed.order;
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      if (particles.is_fixed(i)) continue;
      const Fixed& x = scene_->now[at];
      const Float4& v = scene_->velocity[at];
      particles.x.col(i) = place_of(x.x, x.y, x.z);
      particles.v.col(i) = quantum_ / resident_dt_ * Eigen::Vector3d(v.x, v.y, v.z);
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
      const Float4& v = scene_->velocity_before[at];
      particles.x_start.col(i) = place_of(x.x, x.y, x.z);
      particles.v_start.col(i) = quantum_ / resident_dt_ * Eigen::Vector3d(v.x, v.y, v.z);
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
