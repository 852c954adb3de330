#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "cuda/effects/resident_exchange.h"
#include "cuda/solvers/contact/contact_exchange.h"
#include "cuda/solvers/matrix/iteration_matrix.h"
#include "cuda/solvers/scenes/device_scenes.h"
#include "pliant/core/columns.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/math/error.h"
#include "pliant/solvers/device/backend.h"
#include "pliant/solvers/device/backend_choice.h"
#include "pliant/solvers/iterations/chebyshev.h"
#include "pliant/solvers/iterations/first_iterate.h"
#include "pliant/solvers/iterations/projective_solver.h"
#include "pliant/solvers/iterations/stop_check.h"

namespace pliant {

/// Steps of `jacobi`, `line_search_jacobi`, `gauss_seidel`, `hybrid`, `chebyshev` and `lbfgs` whose
/// iterations an executor runs: forces in single precision, positions in whole quanta (Fixed).
/// Between steps they stay in double precision: a step uploads its prediction, measured from the
/// body's centre, and downloads the displacement from it. Contacts are found on the CPU, where
/// every shape of obstacle is known, and resolved with the iterations. In a batch the iterations
/// are those of all its scenes at once.
template <class Executor>
class DeviceSolver final : public ProjectiveSolver {
 public:
  /// Makes what acts on bodies of particles in a resident run; null: these take none.
  using MakeForces = std::function<std::shared_ptr<ResidentForces<Executor>>()>;

  explicit DeviceSolver(const DeviceSolverSpec& spec, DeviceBatch<Executor>* batch = nullptr,
                        MakeForces make_forces = nullptr)
      : spec_(spec), batch_(batch), make_forces_(std::move(make_forces)) {}
  ~DeviceSolver() override { leave(); }
  std::string_view name() const override { return spec_.name; }
  int resident_limit(const System& system, const ResidentRun& run) override;
  void begin_resident_run(System& system, const ResidentRun& run, StepReport& report) override;
  int finish_resident_run(System& system, std::vector<Reaction>& reactions,
                          StepReport& report) override;
  Readback available() const override { return scene_ ? scene_->available : Readback::kState; }
  const Positions* seen_surface() const override { return &seen_surface_; }
  bool read_back_state(System& system) override;
  /// Steps of the next resident run that are under way already, for those who test it.
  int following() const { return scenes_ ? scenes_->following() : 0; }
  /// The last resident run, for those who time it; null where there was none.
  DeviceResidentRun<Executor>* resident_run() {
    return scenes_ ? scenes_->resident_run() : nullptr;
  }

 protected:
  // Of a thousand vertices, the least that is worth a GPU, by the figures in docs/performance.md.
  double iteration_price() const override { return 0.03; }
  bool guards_energy() const override { return false; }
  void save_learned(StateArchive& numbers) const override;
  void load_learned(StateArchive& numbers) override;
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void begin_solve(ProjectiveSystem& system, double dt, StepReport& report) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  static constexpr int kGrain = 4096;
  // Of the largest distance from the centre; iterates may go four times as far.
  static constexpr double kQuantum = 1.0 / (1 << 28);
  // Moving all particles by so many quanta is round-off, or makes forces too small to judge by.
  static constexpr double kRoundOff = 0.01;
  static constexpr double kNoise = 8.0;

  Fixed fixed(const Eigen::Vector3d& x, double beside) const {
    const auto whole = [&](double value) { return static_cast<int>(std::lrint(value / quantum_)); };
    return {whole(x[0]), whole(x[1]), whole(x[2]), static_cast<float>(beside)};
  }
  /// Of predicted positions, and the farthest coordinate from them to where iterations begin.
  struct Extent {
    Eigen::Array3d low, high;
    double displacement;
    double reach() const { return std::max((high - low).maxCoeff(), displacement); }
  };
  /// Whether anything ties particles, so that a Jacobi iteration has a spectral radius.
  static bool has_elements(const ProjectiveSystem& system) {
    return std::any_of(system.elements.begin(), system.elements.end(),
                       [](const auto& set) { return set->size() > 0; });
  }
  void begin_rigidly(ProjectiveSystem& system, double dt);
  static Extent extent_of(const Positions& predicted, const Positions& start);
  /// Of a resident run: predicted positions are those at its beginning.
  struct Travel {
    Extent extent;
    double distance;  ///< farthest that a coordinate may go in all of its steps [m]
    double reach() const { return extent.reach() + distance; }
    Eigen::Vector3d center() const { return 0.5 * (extent.low + extent.high); }
  };
  static Travel travel_of(const Particles& particles, const ResidentRun& run);
  /// Where the last resident run ended, whether or not its motion was read back.
  Travel travel_from_end(const Particles& particles, const ResidentRun& run) const;
  static Travel travel_of(const Extent& extent, double fastest, const ResidentRun& run);
  std::string why_not(const ProjectiveSystem& system) const;
  DeviceIteration iteration_of(const ProjectiveSystem& system) const;
  void set_rules(const ProjectiveSystem& system, const Eigen::VectorXd& diagonal);
  void set_sweeps(double largest_eigenvalue, double stiffness_ratio);
  void pack_if_changed(const ProjectiveSystem& system, const IterationMatrix& prepared,
                       const DeviceIteration& iteration, const BlockPlan& blocks);
  /// Clusters may have crept since the last step.
  void follow_shapes(const ProjectiveSystem& system);
  /// Of the system: components that nothing holds, but for single particles.
  void set_components(const ProjectiveSystem& system);
  void set_quantum(double reach);
  bool takes(const ProjectiveSystem& system, const ResidentRun& run, const Travel& travel) const;
  void begin_forces(const ProjectiveSystem& system, const ResidentRun& run, const Travel& travel);
  /// Whether `run` is under way already.
  bool follows(const ResidentRun& run) const;
  /// Decides whether what follows a resident run may begin before anybody asks for it.
  void plan_following(const Particles& particles, const ResidentRun& run);
  Eigen::Vector3d place_of(int x, int y, int z) const {
    return center_ + quantum_ * Eigen::Vector3d(x, y, z);
  }
  void take_motion(Particles& particles);
  void take_rest(Particles& particles);
  void take_surface(const Particles& particles);
  void add_reactions(std::vector<Reaction>& reactions) const;
  void join(const DeviceScenesKey& key);
  void leave();
  void set_anchors(const ProjectiveSystem& system, const Eigen::Vector3d& center);
  void run_alone(StepReport& report);
  void take_result(ProjectiveSystem& system);
  void tell(StepReport& report);
  void add_metrics(StepReport& report) const;

  DeviceSolverSpec spec_;
  Relaxation relaxation_;
  Eigen::VectorXd inertia_;  // M/h² [N/m]
  StepObjective objective_;  // for where a step begins
  double diagonal_sum_ = 0.0;
  std::vector<long> structure_;  // of the scene's packed system
  DeviceBatch<Executor>* batch_;
  MakeForces make_forces_;
  std::shared_ptr<ResidentForces<Executor>> forces_;  // null: not needed yet
  std::shared_ptr<DeviceScenes<Executor>> scenes_;
  DeviceScene* scene_ = nullptr;  // its own
  Positions predicted_;
  double quantum_ = 1.0;  // [m]
  // Of the present resident run.
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();  // [m]
  double resident_dt_ = 0.0;                          // [s]
  std::vector<int> obstacles_;                        // numbers of those that it looks at
  Positions seen_surface_;                            // [m]
};

// As the solvers of these names write and read them, so that a swap between backends keeps what was
// learned.
template <class Executor>
void DeviceSolver<Executor>::save_learned(StateArchive& numbers) const {
  if (!spec_.is_accelerated) return;
  numbers.write(scene_->rules.is_damped ? 1.0 : 0.0);
  numbers.write(scene_->is_estimated ? 1.0 : 0.0);
  numbers.write(scene_->estimate);
}

template <class Executor>
void DeviceSolver<Executor>::load_learned(StateArchive& numbers) {
  if (!spec_.is_accelerated) return;
  scene_->rules.is_damped = numbers.read() == 1.0;
  const bool is_estimated = numbers.read() == 1.0;
  const double estimate = numbers.read();
  if (spec_.rho > 0.0) return;
  scene_->is_estimated = is_estimated;
  scene_->estimate = estimate;
}

template <class Executor>
typename DeviceSolver<Executor>::Extent DeviceSolver<Executor>::extent_of(
    const Positions& predicted, const Positions& start) {
  return parallel_reduce(
      0, static_cast<int>(predicted.cols()), kGrain,
      [&](int begin, int end) {
        Extent part = {predicted.col(begin), predicted.col(begin), 0.0};
        for (int i = begin; i < end; ++i) {
          part.low = part.low.min(predicted.col(i).array());
          part.high = part.high.max(predicted.col(i).array());
          part.displacement =
              std::max(part.displacement, (start.col(i) - predicted.col(i)).cwiseAbs().maxCoeff());
        }
        return part;
      },
      [](const Extent& a, const Extent& b) {
        return Extent{a.low.min(b.low), a.high.max(b.high),
                      std::max(a.displacement, b.displacement)};
      });
}

template <class Executor>
void DeviceSolver<Executor>::set_quantum(double reach) {
  quantum_ = std::max(kQuantum * reach, 1e-30);
  StepRules& rules = scene_->rules;
  rules.quantum = static_cast<float>(quantum_);
  const double unit = std::sqrt(diagonal_sum_) * quantum_;
  rules.round_off = kRoundOff * unit;
  rules.noise = kNoise * unit;
}

template <class Executor>
void DeviceSolver<Executor>::begin_solve(ProjectiveSystem& system, double dt, StepReport& report) {
  if (spec_.rule.iterations == 0) return reset_constraints(system);
  const ScopedPhase phase(report, "upload");
  follow_shapes(system);
  scene_->is_due = true;
  scene_->resident_steps = 0;
  scenes_->forget_following();
  Particles& particles = system.particles;
  parallel_copy(particles.x, predicted_);
  if (report.step > 1) start_near_solution(system, dt);
  begin_rigidly(system, dt);
  const Extent extent = extent_of(predicted_, particles.x);
  const Eigen::Vector3d center = 0.5 * (extent.low + extent.high);
  set_quantum(extent.reach());
  const std::vector<int>& order = scene_->packed.order;
  scene_->predicted.resize(order.size());
  scene_->start.resize(order.size());
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      scene_->predicted[at] = fixed(predicted_.col(i) - center, inertia_[i]);
      scene_->start[at] = fixed(particles.x.col(i) - center, 0.0);
    }
  });
  set_anchors(system, center);
  pack_spins(system, scene_->packed, scene_->spins);
  reset_constraints(system);
  collect_contacts(system, predicted_, scene_->packed.place, scene_->contacts);
}

template <class Executor>
void DeviceSolver<Executor>::begin_rigidly(ProjectiveSystem& system, double dt) {
  if (system.constraints.empty() || !momentum().is_used()) return;
  objective_.begin_step(predicted_);
  momentum().begin(system, objective_, relaxation_.mobility, dt);
}

template <class Executor>
void DeviceSolver<Executor>::solve(ProjectiveSystem& system, double /*dt*/, StepReport& report) {
  report.backend = "cuda";
  if (spec_.rule.iterations == 0) return end_step(system, relaxation_.mobility, report);
  if (batch_ == nullptr) {
    run_alone(report);
  } else if (!batch_->failure().empty()) {
    throw DeviceFailure(batch_->failure());
  } else if (scene_->is_due) {
    throw DeviceFailure("a batch takes whole steps, but this one is a substep");
  }
  {
    const ScopedPhase phase(report, "download");
    take_result(system);
  }
  tell(report);
  end_step(system, relaxation_.mobility, report);
}

template <class Executor>
void DeviceSolver<Executor>::run_alone(StepReport& report) {
  {
    const ScopedPhase phase(report, "upload");
    scenes_->upload();
  }
  {
    const ScopedPhase phase(report, "iterations");
    scenes_->iterate();
  }
  const ScopedPhase phase(report, "download");
  scenes_->download();
}

template <class Executor>
void DeviceSolver<Executor>::set_anchors(const ProjectiveSystem& system,
                                         const Eigen::Vector3d& center) {
  std::vector<Eigen::Vector4d> sums;  // Σ k a, Σ k
  for (const auto& set : system.elements) {
    const AttachmentSet* attachments = as<AttachmentSet>(*set);
    if (attachments == nullptr || attachments->size() == 0) continue;
    sums.resize(scene_->packed.order.size(), Eigen::Vector4d::Zero());
    for (const AttachmentSet::Attachment& attachment : attachments->attachments()) {
      const double k = attachment.stiffness;
      const int at = scene_->packed.place[static_cast<std::size_t>(attachment.particle)];
      sums[static_cast<std::size_t>(at)].head<3>() +=
          k * (attachments->target(attachment) - center);
      sums[static_cast<std::size_t>(at)][3] += k;
    }
  }
  scene_->anchors.clear();
  for (const Eigen::Vector4d& sum : sums) {
    // A target far from the body pulls as far as can be counted.
    const Eigen::Vector3d mean = sum.head<3>() / std::max(sum[3], 1e-300);
    const double most = quantum_ * (1 << 30);
    scene_->anchors.push_back(fixed(mean.cwiseMax(-most).cwiseMin(most), sum[3]));
  }
}

template <class Executor>
void DeviceSolver<Executor>::take_result(ProjectiveSystem& system) {
  Positions& x = system.particles.x;
  const std::vector<int>& order = scene_->packed.order;
  parallel_for(0, system.particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order[at];
      const Float4 d = scene_->displacement[at];
      x.col(i) = predicted_.col(i) + Eigen::Vector3d(d.x, d.y, d.z);
    }
  });
  return_forces(scene_->contacts, system);
}

template <class Executor>
void DeviceSolver<Executor>::tell(StepReport& report) {
  const StepControl& control = scene_->control;
  StopCheck stop(spec_.rule, report);
  report.iterations = control.done_at;
  report.residual = control.residual;
  report.ended_by = EndedBy::kIterations;
  if (control.is_round_off) {
    report.ended_by = EndedBy::kRoundOff;
  } else if (spec_.rule.tolerance > 0.0 && control.residual <= spec_.rule.tolerance) {
    report.ended_by = EndedBy::kTolerance;
  }
  // No iteration betters what single precision leaves.
  if (spec_.rule.tolerance > 0.0 && control.residual * control.scale <= scene_->rules.noise) {
    report.ended_by = EndedBy::kRoundOff;
  } else {
    stop.warn_unless_converged();
    stop.warn_of_large_residual();
  }
  if (control.damped && !scene_->rules.is_damped) {
    scene_->rules.is_damped = control.stays_damped();
    report.warn("momentum_slowed: iterations with momentum grew; they take shorter steps now");
  }
  if (control.lowered) {
    scene_->estimate = std::min(scene_->estimate, control.radius);
    report.warn(
        "spectral_radius_lowered: an accelerated iteration grew; the recurrence began anew");
  }
  add_metrics(report);
}

template <class Executor>
void DeviceSolver<Executor>::add_metrics(StepReport& report) const {
  const StepControl& control = scene_->control;
  const PackedMatrix& matrix = scene_->packed.matrix;
  if (matrix.kind == DeviceIteration::kSweep) {
    report.add_metric("colors", matrix.colors);
    report.add_metric("overflow", matrix.overflow);
    return;
  }
  if (matrix.kind == DeviceIteration::kQuasiNewton) {
    report.add_metric("halved_steps", control.shortened);
    return;
  }
  report.add_metric("relaxation", control.step * relaxation_.gamma);
  if (!spec_.is_accelerated) return;
  report.add_metric("spectral_radius", control.radius);
  report.add_metric("restarts", control.restarts);
}

}  // namespace pliant

#include "cuda/solvers/scenes/device_solver_prepare.h"
#include "cuda/solvers/scenes/device_solver_resident.h"
