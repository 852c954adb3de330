#pragma once

#include "cuda/solvers/scenes/device_solver.h"

/// What a DeviceSolver does before its first step, and after each change of its system.
namespace pliant {

template <class Executor>
void DeviceSolver<Executor>::join(const DeviceScenesKey& key) {
  if (scenes_ && scenes_->key() == key) return;
  leave();
  scenes_ = batch_ ? batch_->scenes(key) : std::make_shared<DeviceScenes<Executor>>(key);
  scene_ = &scenes_->add();
}

template <class Executor>
void DeviceSolver<Executor>::leave() {
  if (!scenes_) return;
  *scene_ = DeviceScene();
  scene_->is_there = false;
  scenes_->changed();
}

template <class Executor>
std::string DeviceSolver<Executor>::why_not(const ProjectiveSystem& system) const {
  if (!spec_.cpu_only.empty()) return spec_.cpu_only;
  std::string reason = why_not_packed(system);
  if (reason.empty()) reason = why_not_exchanged(system.constraints);
  if (reason.empty() && spec_.rule.budget > 0.0) {
    reason = "'budget' is for the CPU only; give 'iterations' or 'tolerance'";
  }
  if (reason.empty() && spec_.rule.error > 0.0) {
    reason = "'error' is for the CPU only; give 'iterations' or 'tolerance'";
  }
  return reason;
}

template <class Executor>
DeviceIteration DeviceSolver<Executor>::iteration_of(const ProjectiveSystem& system) const {
  // Of constraints that a sweep does not know the GPU takes none.
  return iteration_for(spec_.iteration, system);
}

template <class Executor>
void DeviceSolver<Executor>::prepare_system(const ProjectiveSystem& system, double dt) {
  const std::string reason = why_not(system);
  if (!reason.empty()) throw InputError(reason);
  const DeviceIteration iteration = iteration_of(system);
  const IterationMatrix prepared = prepare_iteration(system, dt, iteration);
  relaxation_ = prepared.relaxation;
  inertia_ = system.particles.mass / (dt * dt);
  objective_.prepare(system, dt);
  diagonal_sum_ = prepared.diagonal.sum();
  const BlockPlan blocks = plan_blocks(system.particles.size());
  // The first two iterations of a sweep with contact tell how large forces are, as on the CPU.
  const int delay = iteration.kind == DeviceIteration::kSweep ? 2 : spec_.delay;
  join({spec_.rule.iterations, delay, blocks.block, blocks.passes, iteration.kind,
        iteration.history, iteration.sweeps, iteration.is_multigrid});
  DeviceScene& scene = *scene_;
  pack_if_changed(system, prepared, iteration, blocks);
  scene.mobility.resize(scene.packed.order.size());
  for (std::size_t k = 0; k < scene.mobility.size(); ++k) {
    scene.mobility[k] = static_cast<float>(relaxation_.mobility[scene.packed.order[k]]);
  }
  scenes_->mobility_changed();
  set_components(system);
  set_rules(system, prepared.diagonal);
  scene.rules.spread = static_cast<float>(iteration.spread);
  // As ChebyshevSolver; jacobi ends with its last iterate, whatever became of it.
  scene.rules.keeps_best = iteration.kind == DeviceIteration::kJacobi && spec_.is_accelerated;
  // A sweep asks contacts at its end for the first time.
  const bool asks_later = iteration.kind == DeviceIteration::kSweep && !system.constraints.empty();
  scene.rules.least = asks_later ? 2 : 1;
  scene.estimate = spec_.rho;
  scene.is_estimated = !spec_.is_accelerated || spec_.rho > 0.0 || !has_elements(system);
}

template <class Executor>
void DeviceSolver<Executor>::set_components(const ProjectiveSystem& system) {
  const Components components = find_components(system);
  std::vector<int>& members = scene_->component_members;
  std::vector<int>& begins = scene_->component_begins;
  members.clear();
  begins.assign(1, 0);
  for (int c = 0; c < components.count(); ++c) {
    const auto k = static_cast<std::size_t>(c);
    const int begin = components.begins[k], end = components.begins[k + 1];
    // A particle that nothing ties to others answers forces by its own inertia in any case.
    if (components.held[k] || end - begin < 2) continue;
    for (int m = begin; m < end; ++m) {
      const int particle = components.members[static_cast<std::size_t>(m)];
      members.push_back(scene_->packed.place[static_cast<std::size_t>(particle)]);
    }
    begins.push_back(static_cast<int>(members.size()));
  }
}

template <class Executor>
void DeviceSolver<Executor>::set_rules(const ProjectiveSystem& system,
                                       const Eigen::VectorXd& diagonal) {
  const double lambda = std::max(relaxation_.largest_eigenvalue, 1e-300);
  StepRules& rules = scene_->rules;
  rules = {};
  rules.gamma = relaxation_.gamma;
  rules.damped = std::min(1.0, 1.0 / (relaxation_.gamma * lambda));
  rules.tolerance = spec_.rule.tolerance;
  rules.particles = system.particles.size();
  rules.may_raise = spec_.is_accelerated && spec_.rho == 0.0;
  rules.is_accelerated = spec_.is_accelerated;
  double stiffness_ratio = 1.0;
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) continue;
    stiffness_ratio = std::max(stiffness_ratio, diagonal[i] / inertia_[i]);
  }
  set_sweeps(lambda, stiffness_ratio);
  if (!spec_.is_accelerated) return;
  rules.rho_bound = ChebyshevSolver::largest_radius(relaxation_, stiffness_ratio,
                                                    spec_.rule.iterations, spec_.delay);
}

template <class Executor>
void DeviceSolver<Executor>::set_sweeps(double largest_eigenvalue, double stiffness_ratio) {
  // Where sweeps are too few for the smallest eigenvalue, they leave a third of all down to this
  // one, and more of those below.
  constexpr double kReach = 0.77;
  const DeviceScenesKey& key = scenes_->key();
  const double sweeps = std::max(1, key.sweeps);
  const double reached = kReach * largest_eigenvalue / (sweeps * sweeps);
  double least = std::min(largest_eigenvalue, std::max(1.0 / stiffness_ratio, reached));
  if (key.is_multigrid) least = largest_eigenvalue / Smoother::kRange;
  scene_->rules.largest_eigenvalue = static_cast<float>(largest_eigenvalue);
  scene_->rules.least_eigenvalue = static_cast<float>(least);
}

template <class Executor>
void DeviceSolver<Executor>::pack_if_changed(const ProjectiveSystem& system,
                                             const IterationMatrix& prepared,
                                             const DeviceIteration& iteration,
                                             const BlockPlan& blocks) {
  // A time step of another length changes nothing of it, unless it has coarse matrices.
  std::vector<long> structure = structure_of(system);
  const bool is_same = !structure.empty() && structure == structure_ && !iteration.is_multigrid;
  if (is_same && !scene_->packed.order.empty()) return;
  scene_->packed = pack(system, blocks.block, blocks.passes);
  scene_->packed.matrix = pack_matrix(prepared, iteration, inertia_, scene_->packed);
  structure_ = std::move(structure);
  scenes_->changed();
}

template <class Executor>
void DeviceSolver<Executor>::follow_shapes(const ProjectiveSystem& system) {
  std::vector<long> structure = structure_of(system);
  if (structure == structure_) return;
  pack_clusters(system, scene_->packed);
  structure_ = std::move(structure);
  scenes_->changed();
}

}  // namespace pliant
