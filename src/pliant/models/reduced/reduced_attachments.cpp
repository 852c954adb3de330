#include "pliant/models/reduced/reduced_attachments.h"

#include <algorithm>
#include <cmath>

#include "pliant/math/small_solve.h"

namespace pliant {
namespace {

bool is_limited(const AttachmentSet& set) {
  return set.size() > 0 && std::isfinite(set.force_limit());
}

/// The largest s in [0, 1] with |a + s b| <= limit, for |a| <= limit.
double largest_share(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double limit) {
  if ((a + b).norm() <= limit) return 1.0;
  const double room = std::max(0.0, limit * limit - a.squaredNorm());
  // s² b² + 2 s a·b = room, in the form that cancels nothing for a·b > 0.
  const double slope = a.dot(b), square = b.squaredNorm();
  const double root = std::sqrt(slope * slope + square * room);
  return std::clamp(slope > 0.0 ? room / (slope + root) : (root - slope) / square, 0.0, 1.0);
}

}  // namespace

ReducedAttachments::ReducedAttachments(const ReducedVertices& vertices) : vertices_(vertices) {
  guess_ = guess_start_ = Eigen::VectorXd::Zero(vertices.rank());
}

double ReducedAttachments::energy(const Positions& x) const {
  double sum = 0.0;
  for (const auto& set : sets_) sum += set->energy(x);
  return sum;
}

void ReducedAttachments::update_stiffness() {
  long version = 0;
  bool holds = false;
  for (const auto& set : sets_) {
    version += set->version();
    holds |= set->size() > 0;
  }
  if (version == version_) return;
  version_ = version;
  h_ = 0.0;
  stiffness_.resize(0, 0);
  if (!holds) return;
  stiffness_.setZero(vertices_.rank(), vertices_.rank());
  for (const auto& set : sets_) {
    for (const AttachmentSet::Attachment& a : set->attachments()) {
      const auto rows = vertices_.rows(a.particle);
      stiffness_ += a.stiffness * rows * rows.transpose();
    }
  }
}

void ReducedAttachments::update_response(const StepResponse& free, double h) {
  if (h == h_ && free.q == known_.q && free.p == known_.p) return;
  h_ = h;
  known_ = free;
  const auto identity = Eigen::MatrixXd::Identity(vertices_.rank(), vertices_.rank());
  // (C⁻¹ + ½ K)⁻¹ = √C (1 + ½ √C K √C)⁻¹ √C
  const Eigen::VectorXd root = free.q.cwiseSqrt();
  const Eigen::MatrixXd inner = root.asDiagonal() * stiffness_ * root.asDiagonal();
  q_response_ = DenseCholesky(identity + 0.5 * inner).solve(Eigen::MatrixXd(root.asDiagonal()));
  q_response_ = (root.asDiagonal() * q_response_).eval();
  p_response_ = free.p.asDiagonal() * (identity - 0.5 * stiffness_ * q_response_);
  damper_.compute(identity + 0.5 * h * h * stiffness_);
}

void ReducedAttachments::update_targets() {
  target_start_.setZero(vertices_.rank());
  target_.setZero(vertices_.rank());
  for (const auto& set : sets_) {
    for (const AttachmentSet::Attachment& a : set->attachments()) {
      const auto rows = vertices_.rows(a.particle);
      const auto rest = vertices_.rest().col(a.particle);
      const Eigen::Vector3d start = a.stiffness * (set->frame_start() * a.point - rest);
      const Eigen::Vector3d end = a.stiffness * (set->frame() * a.point - rest);
      target_start_ += rows.lazyProduct(start);
      target_ += rows.lazyProduct(end);
    }
  }
  target_mean_ = 0.5 * (target_start_ + target_);
}

void ReducedAttachments::begin_step() {
  guess_start_ = guess_;
  if (sets_.empty()) return;
  update_stiffness();
  if (is_holding()) {
    update_targets();
  } else {
    guess_.setZero();
  }
}

Eigen::Vector3d ReducedAttachments::spring_force(const AttachmentSet& set,
                                                 const Eigen::VectorXd& q_sum) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const AttachmentSet::Attachment& a : set.attachments()) {
    const Eigen::Vector3d target = 0.5 * (set.frame_start() * a.point + set.frame() * a.point);
    const Eigen::Vector3d moved = vertices_.rows(a.particle).transpose().lazyProduct(q_sum);
    sum += a.stiffness * (target - vertices_.rest().col(a.particle) - 0.5 * moved);
  }
  return sum;
}

Eigen::Vector3d ReducedAttachments::damper_force(const AttachmentSet& set, double h,
                                                 const Eigen::VectorXd& p) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const AttachmentSet::Attachment& a : set.attachments()) {
    const Eigen::Vector3d target = set.frame() * a.point - set.frame_start() * a.point;
    const Eigen::Vector3d speed = vertices_.rows(a.particle).transpose().lazyProduct(p);
    sum += 0.5 * a.stiffness * (target - h * speed);
  }
  return sum;
}

/// Shifts the frame by t where the force F is above the limit L: of b by B t with B = Σ k Uᵢᵀ, so
/// that F changes by (Σ k - ½ Bᵀ C B) t, to L F / |F|.
void ReducedAttachments::shift_frame(AttachmentSet& set) {
  force_ = target_mean_;
  force_.noalias() -= 0.5 * stiffness_.lazyProduct(q_sum_);
  const Eigen::Vector3d force = spring_force(set, q_sum_ + q_response_ * force_);
  if (!(force.norm() > set.force_limit())) return;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(vertices_.rank(), 3);
  double stiffness = 0.0;
  for (const AttachmentSet::Attachment& a : set.attachments()) {
    b += a.stiffness * vertices_.rows(a.particle);
    stiffness += a.stiffness;
  }
  Eigen::Matrix3d slope = stiffness * Eigen::Matrix3d::Identity();
  slope -= 0.5 * b.transpose() * q_response_ * b;
  const Eigen::Vector3d excess = (set.force_limit() / force.norm() - 1.0) * force;
  const Eigen::Translation3d shift(solve_pivoted<3, 1>(slope, excess));
  set.move_frame(shift * set.frame_start(), shift * set.frame());
  update_targets();
}

void ReducedAttachments::damp(double h, Eigen::VectorXd& p) {
  p_damped_ = p + 0.5 * h * (target_ - target_start_);
  damper_.solve_in_place(p_damped_);
  damper_share_ = 1.0;
  for (const auto& set : sets_) {
    if (!is_limited(*set)) continue;
    const double share = largest_share(spring_force(*set, q_sum_), damper_force(*set, h, p_damped_),
                                       set->force_limit());
    damper_share_ = std::min(damper_share_, share);
  }
  if (damper_share_ == 1.0) {
    p = p_damped_;
  } else {
    p += damper_share_ * (p_damped_ - p);
  }
}

void ReducedAttachments::hold(double h, const StepResponse& free, const Eigen::VectorXd& q_start,
                              Eigen::VectorXd& q, Eigen::VectorXd& p) {
  if (!is_holding()) return;
  update_response(free, h);
  q -= free.q.cwiseProduct(guess_);
  p -= free.p.cwiseProduct(guess_);
  q_sum_ = q_start + q;
  for (const auto& set : sets_) {
    if (is_limited(*set)) shift_frame(*set);
  }
  force_ = target_mean_;
  force_.noalias() -= 0.5 * stiffness_.lazyProduct(q_sum_);
  q.noalias() += q_response_.lazyProduct(force_);
  p.noalias() += p_response_.lazyProduct(force_);
  q_sum_ = q_start + q;
  damp(h, p);
}

ReducedResponse ReducedAttachments::response(const StepResponse& free) const {
  return is_holding() ? ReducedResponse(free, q_response_, p_response_) : ReducedResponse(free);
}

void ReducedAttachments::finish(const Eigen::VectorXd& q_start, const Eigen::VectorXd& q) {
  if (!is_holding()) return;
  q_sum_ = q_start + q;
  guess_ = target_mean_;
  guess_.noalias() -= 0.5 * stiffness_.lazyProduct(q_sum_);
  for (const auto& set : sets_) {
    if (!is_limited(*set)) continue;
    set->tell_force(spring_force(*set, q_sum_) + damper_share_ * damper_force(*set, h_, p_damped_));
  }
}

}  // namespace pliant
