#pragma once

#include <memory>
#include <optional>

#include "cuda/solvers/contact_exchange.h"
#include "cuda/solvers/device_step.h"
#include "pliant/core/parallel.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/math/error.h"
#include "pliant/solvers/backend.h"
#include "pliant/solvers/chebyshev.h"
#include "pliant/solvers/first_iterate.h"
#include "pliant/solvers/projective_matrix.h"
#include "pliant/solvers/projective_solver.h"
#include "pliant/solvers/stop_check.h"

namespace pliant {

/// Steps of `jacobi` and `chebyshev` whose iterations an executor runs: forces in single precision,
/// positions in whole quanta (Fixed). Between steps they stay in double precision: a step uploads
/// its prediction, measured from the body's centre, and downloads the way from it. Contacts are
/// found on the CPU, where every shape of obstacle is known, and resolved with the iterations.
template <class Executor>
class DeviceSolver final : public ProjectiveSolver {
 public:
  explicit DeviceSolver(const DeviceSolverSpec& spec) : spec_(spec) {}
  std::string_view name() const override { return spec_.name; }
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;

 protected:
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  static constexpr int kGrain = 4096;
  // Small bodies have too few blocks to fill a GPU: several threads then share a particle's
  // elements. Large ones do best with few threads, since blocks wait for their slowest.
  static constexpr int kLarge = 40000;
  static constexpr int kPreSimulation = 40;  // as ChebyshevSolver
  // Of the largest distance from the centre; iterates may go four times as far.
  static constexpr double kQuantum = 1.0 / (1 << 28);
  // Moving all particles by so many quanta is round-off, or makes forces too small to judge by.
  static constexpr double kRoundOff = 0.01;
  static constexpr double kNoise = 8.0;

  Fixed fixed(const Eigen::Vector3d& x, double beside) const {
    const auto whole = [&](double value) { return static_cast<int>(std::lrint(value / quantum_)); };
    return {whole(x[0]), whole(x[1]), whole(x[2]), static_cast<float>(beside)};
  }
  void upload(ProjectiveSystem& system, double dt, StepReport& report);
  void upload_anchors(const ProjectiveSystem& system, const Eigen::Vector3d& center);
  /// The radius of a Jacobi iteration, from the changes of successive ones (as ChebyshevSolver).
  void estimate();
  void download(ProjectiveSystem& system, StepReport& report);
  void tell(StepReport& report);

  DeviceSolverSpec spec_;
  Relaxation relaxation_;
  Eigen::VectorXd inertia_;  // M/h² [N/m]
  double diagonal_sum_ = 0.0;
  std::unique_ptr<DeviceStep<Executor>> step_;
  std::vector<int> order_, place_;
  bool has_anchors_ = false;
  StepRules rules_;
  bool is_estimated_ = false;
  double estimate_ = 0.0;
  Positions predicted_;
  double quantum_ = 1.0;  // [m]
  std::vector<Fixed> upload_y_, upload_x_;
  std::vector<Float4> displacement_;
  ContactTable contacts_;
};

// As the solvers of these names write and read them, so that a swap between backends keeps what was
// learned.
template <class Executor>
void DeviceSolver<Executor>::save(SavedNumbers& numbers) const {
  if (!spec_.is_accelerated) return;
  numbers.write(0.0);  // careful; here a step forgets that
  numbers.write(is_estimated_ ? 1.0 : 0.0);
  numbers.write(estimate_);
}

template <class Executor>
void DeviceSolver<Executor>::load(SavedNumbers& numbers) {
  if (!spec_.is_accelerated) return;
  numbers.read();
  if (spec_.rho > 0.0) return;
  is_estimated_ = numbers.read() == 1.0;
  estimate_ = numbers.read();
}

template <class Executor>
void DeviceSolver<Executor>::prepare_system(const ProjectiveSystem& system, double dt) {
  std::string reason = why_not_packed(system);
  if (reason.empty()) reason = why_not_exchanged(system.couplings);
  if (reason.empty() && spec_.rule.budget > 0.0) {
    reason = "'budget' is for the CPU only; give 'iterations' or 'tolerance'";
  }
  if (!reason.empty()) throw InputError(reason);
  const SparseRows matrix = projective_matrix(system, dt);
  relaxation_ = make_relaxation(matrix, system.particles);
  inertia_ = system.particles.mass / (dt * dt);
  const Eigen::VectorXd diagonal = matrix.diagonal();
  diagonal_sum_ = diagonal.sum();
  const bool is_large = system.particles.size() >= kLarge;
  const PackedSystem packed = pack(system, is_large ? 128 : 64);
  order_ = packed.order;
  place_ = packed.place;
  step_ = std::make_unique<DeviceStep<Executor>>(packed, is_large ? 1 : 4);
  std::vector<float> mobility(order_.size());
  double stiffness_ratio = 1.0;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const int i = order_[k];
    mobility[k] = static_cast<float>(relaxation_.mobility[i]);
    if (!system.particles.is_fixed(i)) {
      stiffness_ratio = std::max(stiffness_ratio, diagonal[i] / inertia_[i]);
    }
  }
  step_->set_mobility(mobility);
  const double lambda = std::max(relaxation_.largest_eigenvalue, 1e-300);
  rules_ = {};
  rules_.gamma = relaxation_.gamma;
  rules_.careful = std::min(1.0, 1.0 / (relaxation_.gamma * lambda));
  rules_.tolerance = spec_.rule.tolerance;
  rules_.delay = spec_.delay;
  rules_.may_raise = spec_.is_accelerated && spec_.rho == 0.0;
  rules_.is_accelerated = spec_.is_accelerated;
  if (spec_.is_accelerated) {
    rules_.rho_bound = ChebyshevSolver::largest_radius(relaxation_, stiffness_ratio,
                                                       spec_.rule.iterations, spec_.delay);
  }
  estimate_ = spec_.rho;
  is_estimated_ = !spec_.is_accelerated || spec_.rho > 0.0;
}

template <class Executor>
void DeviceSolver<Executor>::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  report.backend = "cuda";
  if (spec_.rule.iterations == 0) {
    reset_couplings(system);
    return finish_couplings(system, relaxation_.mobility, report);
  }
  {
    ScopedPhase phase(report, "upload");
    upload(system, dt, report);
  }
  {
    ScopedPhase phase(report, "iterations");
    if (!is_estimated_ && spec_.rule.iterations > spec_.delay) estimate();
    rules_.rho = std::min(estimate_, rules_.rho_bound);
    step_->set_rules(rules_);
    step_->run(spec_.rule.iterations);
    step_->executor().synchronize();
  }
  {
    ScopedPhase phase(report, "download");
    download(system, report);
  }
  tell(report);
  finish_couplings(system, relaxation_.mobility, report);
}

template <class Executor>
void DeviceSolver<Executor>::upload(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& particles = system.particles;
  predicted_ = particles.x;
  if (!system.couplings.empty() && report.step > 1) start_near_solution(system, dt);
  const Eigen::Vector3d low = predicted_.rowwise().minCoeff(),
                        high = predicted_.rowwise().maxCoeff();
  const Eigen::Vector3d center = 0.5 * (low + high);
  const double reach =
      std::max((high - low).maxCoeff(), (particles.x - predicted_).cwiseAbs().maxCoeff());
  quantum_ = std::max(kQuantum * reach, 1e-30);
  rules_.quantum = static_cast<float>(quantum_);
  const double unit = std::sqrt(diagonal_sum_) * quantum_;
  rules_.round_off = kRoundOff * unit;
  rules_.noise = kNoise * unit;
  upload_y_.resize(order_.size());
  upload_x_.resize(order_.size());
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order_[at];
      upload_y_[at] = fixed(predicted_.col(i) - center, inertia_[i]);
      upload_x_[at] = fixed(particles.x.col(i) - center, 0.0);
    }
  });
  step_->set_prediction(upload_y_, upload_x_);
  upload_anchors(system, center);
  reset_couplings(system);
  collect_contacts(system, predicted_, place_, contacts_);
  step_->set_contacts(contacts_);
  step_->set_rules(rules_);
}

template <class Executor>
void DeviceSolver<Executor>::upload_anchors(const ProjectiveSystem& system,
                                            const Eigen::Vector3d& center) {
  std::vector<Eigen::Vector4d> sums;  // Σ k a, Σ k
  for (const auto& set : system.elements) {
    const auto* attachments = dynamic_cast<const AttachmentSet*>(set.get());
    if (attachments == nullptr || attachments->size() == 0) continue;
    sums.resize(order_.size(), Eigen::Vector4d::Zero());
    for (const AttachmentSet::Attachment& attachment : attachments->attachments()) {
      const double k = attachment.stiffness;
      const auto at = place_[static_cast<std::size_t>(attachment.particle)];
      sums[static_cast<std::size_t>(at)].head<3>() +=
          k * (attachments->target(attachment) - center);
      sums[static_cast<std::size_t>(at)][3] += k;
    }
  }
  std::vector<Fixed> anchors;
  for (const Eigen::Vector4d& sum : sums) {
    // A target far from the body pulls as far as can be counted.
    const Eigen::Vector3d mean = sum.head<3>() / std::max(sum[3], 1e-300);
    const double most = quantum_ * (1 << 30);
    anchors.push_back(fixed(mean.cwiseMax(-most).cwiseMin(most), sum[3]));
  }
  if (!anchors.empty() || has_anchors_) step_->set_anchors(anchors);
  has_anchors_ = !anchors.empty();
}

template <class Executor>
void DeviceSolver<Executor>::estimate() {
  double last = 0.0, ratio = 0.0;
  for (int k = 0; k < kPreSimulation; ++k) {
    // |D^-1/2 r| from |J(y) - y|² / γ.
    const double squared = step_->plain_iteration(k);
    const double pulled = std::sqrt(squared / rules_.gamma);
    if (k == 0 && pulled <= rules_.noise) return;  // a body in free fall says nothing
    if (pulled <= rules_.noise) break;
    if (last > 0.0) ratio = std::sqrt(squared / last);
    last = squared;
  }
  estimate_ = ratio;
  is_estimated_ = true;
}

template <class Executor>
void DeviceSolver<Executor>::download(ProjectiveSystem& system, StepReport&) {
  step_->displacement(displacement_);
  Positions& x = system.particles.x;
  parallel_for(0, system.particles.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = order_[at];
      const Float4 d = displacement_[at];
      x.col(i) = predicted_.col(i) + Eigen::Vector3d(d.x, d.y, d.z);
    }
  });
  step_->contact_forces(contacts_.forces);
  return_forces(contacts_, system);
}

template <class Executor>
void DeviceSolver<Executor>::tell(StepReport& report) {
  const StepControl control = step_->control();
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
  if (spec_.rule.tolerance > 0.0 && control.residual * control.scale <= rules_.noise) {
    report.ended_by = EndedBy::kRoundOff;
  } else {
    stop.warn_unless_converged();
  }
  if (control.careful) {
    report.warn("momentum_slowed: iterations with momentum grew; they take shorter steps now");
  }
  if (control.lowered) {
    estimate_ = std::min(estimate_, control.radius);
    report.warn(
        "spectral_radius_lowered: an accelerated iteration grew; the recurrence began anew");
  }
  report.add_figure("relaxation", relaxation_.gamma);
  if (!spec_.is_accelerated) return;
  report.add_figure("spectral_radius", control.radius);
  report.add_figure("restarts", control.restarts);
}

}  // namespace pliant
