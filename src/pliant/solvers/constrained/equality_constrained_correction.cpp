#include "pliant/solvers/constrained/equality_constrained_correction.h"

#include <cmath>

namespace pliant {
namespace {
constexpr int kMaxIterations = 60;
}  // namespace

void EqualityConstrainedCorrection::reserve(int rows) {
  if (rows <= scale_.size()) return;
  for (Eigen::VectorXd* v :
       {&scale_, &compliance_, &residual_, &preconditioned_, &direction_, &product_}) {
    v->resize(2 * rows);
  }
}

void EqualityConstrainedCorrection::normalise(const ConstraintRows& rows,
                                              const Particles& particles) {
  scale_.setZero();
  compliance_.setZero();
  for (int r = 0; r < rows.size(); ++r) {
    double sum = 0.0;
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      if (!particles.is_fixed(entry->particle)) sum += entry->gradient.squaredNorm();
    }
    if (sum == 0.0) continue;
    scale_[r] = 1.0 / std::sqrt(sum);
    compliance_[r] = rows.compliance(r) / sum;
  }
}

void EqualityConstrainedCorrection::spread(const ConstraintRows& rows, const Particles& particles,
                                           const RowVector& mu) {
  moved_.setZero(3, particles.size());
  for (int r = 0; r < rows.size(); ++r) {
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      if (particles.is_fixed(entry->particle)) continue;
      moved_.col(entry->particle) += scale_[r] * mu[r] * entry->gradient;
    }
  }
}

void EqualityConstrainedCorrection::gather(const ConstraintRows& rows, const Eigen::Matrix3Xd& d,
                                           RowVector mu) const {
  for (int r = 0; r < rows.size(); ++r) {
    double sum = 0.0;
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      sum += entry->gradient.dot(d.col(entry->particle));
    }
    mu[r] = scale_[r] * sum;
  }
}

void EqualityConstrainedCorrection::solve(const ConstraintRows& rows, const Particles& particles,
                                          const LinearOperator& p, const LinearOperator& p_inverse,
                                          Eigen::Matrix3Xd& d) {
  iterations_ = 0;
  p_inverse(d);
  if (rows.size() == 0) return;
  reserve(rows.size());
  normalise(rows, particles);
  const auto size = static_cast<Eigen::Index>(rows.size());
  auto residual = residual_.head(size), preconditioned = preconditioned_.head(size);
  auto direction = direction_.head(size), product = product_.head(size);
  gather(rows, d, residual);
  for (int r = 0; r < rows.size(); ++r) residual[r] -= scale_[r] * rows.target(r);
  const double goal = accuracy_ * residual.norm();
  direction.setZero();
  double last = 1.0;
  while (residual.norm() > goal && iterations_ < kMaxIterations) {
    spread(rows, particles, residual);
    p(moved_);
    gather(rows, moved_, preconditioned);
    const double now = residual.dot(preconditioned);
    direction = preconditioned + (iterations_ == 0 ? 0.0 : now / last) * direction;
    last = now;
    spread(rows, particles, direction);
    p_inverse(moved_);
    gather(rows, moved_, product);
    product += compliance_.head(size).cwiseProduct(direction);
    const double curvature = direction.dot(product);
    if (!(curvature > 0.0)) break;
    const double step = now / curvature;
    d -= step * moved_;
    residual -= step * product;
    ++iterations_;
  }
}

}  // namespace pliant
