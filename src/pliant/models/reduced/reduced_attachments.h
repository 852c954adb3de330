#pragma once

#include <memory>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/math/dense_factors.h"
#include "pliant/models/reduced/reduced_response.h"
#include "pliant/models/reduced/reduced_vertices.h"

namespace pliant {

/// Attachments of a reduced body. With K = Σ k Uᵢᵀ Uᵢ and b = Σ k Uᵢᵀ (aᵢ - Xᵢ) their force on the
/// coordinates is b - K q. Constant during a step, it is that of the step's mean,
///   f = b̄ - ½ K (q + q'),
/// which keeps the energy of a linear body whatever the stiffness. An integrator makes its step
/// with the f of the step before, as a guess; then its response C to a constant force puts f right:
///   q' += (C⁻¹ + ½ K)⁻¹ (...), in closed form.
/// A damper of ½ h k, which is what implicit Euler has by its nature, then takes the speed of what
/// is held too firmly for the step to show how it swings: p' = (1 + ½ h² K)⁻¹ (p' + ½ h Δb).
///
/// A set with a limit pulls no harder in a step: its net force is linear in where its frame is, so
/// that one shift of the frame puts it on the limit, and the damper does no more than the limit
/// leaves it. What contact changes of the step afterwards is not known then.
class ReducedAttachments {
 public:
  explicit ReducedAttachments(const ReducedVertices& vertices);
  void add(std::unique_ptr<AttachmentSet> set) { sets_.push_back(std::move(set)); }

  /// Uᵀ of the forces in the last step [kg^½ m/s²].
  const Eigen::VectorXd& guess() const { return guess_; }
  double energy(const Positions& x) const;  ///< [J]

  /// Before and after a step of h seconds: q, p made with guess() go in, held ones come out.
  void begin_step();
  void hold(double h, const StepResponse& free, const Eigen::VectorXd& q_start, Eigen::VectorXd& q,
            Eigen::VectorXd& p);
  /// What a further force does to the held body.
  ReducedResponse response(const StepResponse& free) const;
  /// Nothing moves the body any more in this step.
  void finish(const Eigen::VectorXd& q_start, const Eigen::VectorXd& q);

  void reset() { guess_.setZero(); }
  void undo_step() { guess_.swap(guess_start_); }
  void save(StateArchive& numbers) const { numbers.write_all(guess_); }
  void load(StateArchive& numbers) { numbers.read_all(guess_); }

 private:
  bool is_holding() const { return stiffness_.size() > 0; }
  void update_stiffness();
  void update_response(const StepResponse& free, double h);
  void update_targets();
  void shift_frame(AttachmentSet& set);
  void damp(double h, Eigen::VectorXd& p);
  /// Net forces on what a set holds [N]: of its springs, where the body goes from q to q' with
  /// `q_sum` = q + q'; and of the damper, where it leaves the momenta p.
  Eigen::Vector3d spring_force(const AttachmentSet& set, const Eigen::VectorXd& q_sum) const;
  Eigen::Vector3d damper_force(const AttachmentSet& set, double h, const Eigen::VectorXd& p) const;

  const ReducedVertices& vertices_;
  std::vector<std::unique_ptr<AttachmentSet>> sets_;
  long version_ = 0;                                     // sum of the sets', of stiffness_
  Eigen::MatrixXd stiffness_;                            // K; empty: nothing is held
  Eigen::VectorXd target_start_, target_, target_mean_;  // b
  double h_ = 0.0;                                       // of what follows
  StepResponse known_;                                   // likewise
  Eigen::MatrixXd q_response_, p_response_;
  DenseCholesky damper_;
  double damper_share_ = 1.0;  // of the damper that the limits leave
  Eigen::VectorXd p_damped_;   // by the whole of it
  Eigen::VectorXd guess_, guess_start_, force_, q_sum_;
};

}  // namespace pliant
