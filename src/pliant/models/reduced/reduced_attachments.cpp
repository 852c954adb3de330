#include "pliant/models/reduced/reduced_attachments.h"

namespace pliant {

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
  q_response_ = (identity + 0.5 * inner).llt().solve(Eigen::MatrixXd(root.asDiagonal()));
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

void ReducedAttachments::hold(double h, const StepResponse& free, const Eigen::VectorXd& q_start,
                              Eigen::VectorXd& q, Eigen::VectorXd& p) {
  if (!is_holding()) return;
  update_response(free, h);
  q -= free.q.cwiseProduct(guess_);
  p -= free.p.cwiseProduct(guess_);
  way_ = q_start + q;
  force_ = target_mean_;
  force_.noalias() -= 0.5 * stiffness_.lazyProduct(way_);
  q.noalias() += q_response_.lazyProduct(force_);
  p.noalias() += p_response_.lazyProduct(force_);
  p += 0.5 * h * (target_ - target_start_);
  damper_.solveInPlace(p);
}

ReducedResponse ReducedAttachments::response(const StepResponse& free) const {
  return is_holding() ? ReducedResponse(free, q_response_, p_response_) : ReducedResponse(free);
}

void ReducedAttachments::finish(const Eigen::VectorXd& q_start, const Eigen::VectorXd& q) {
  if (!is_holding()) return;
  way_ = q_start + q;
  guess_ = target_mean_;
  guess_.noalias() -= 0.5 * stiffness_.lazyProduct(way_);
}

}  // namespace pliant
