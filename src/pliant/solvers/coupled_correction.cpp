#include "pliant/solvers/coupled_correction.h"

#include <cmath>

namespace pliant {
namespace {
// The correction is one of many: what it leaves open the next one takes up.
constexpr double kTolerance = 1e-5;
constexpr int kMaxIterations = 60;
}  // namespace

void CoupledCorrection::normalise(const CouplingRows& rows, const Particles& particles) {
  scale_.setZero(rows.size());
  compliance_.setZero(rows.size());
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

void CoupledCorrection::spread(const CouplingRows& rows, const Particles& particles,
                               const Eigen::VectorXd& mu) {
  moved_.setZero(3, particles.size());
  for (int r = 0; r < rows.size(); ++r) {
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      if (particles.is_fixed(entry->particle)) continue;
      moved_.col(entry->particle) += scale_[r] * mu[r] * entry->gradient;
    }
  }
}

void CoupledCorrection::gather(const CouplingRows& rows, const Eigen::Matrix3Xd& d,
                               Eigen::VectorXd& mu) const {
  mu.resize(rows.size());
  for (int r = 0; r < rows.size(); ++r) {
    double sum = 0.0;
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      sum += entry->gradient.dot(d.col(entry->particle));
    }
    mu[r] = scale_[r] * sum;
  }
}

void CoupledCorrection::solve(const CouplingRows& rows, const Particles& particles,
                              const LinearOperator& p, const LinearOperator& p_inverse,
                              Eigen::Matrix3Xd& d) {
  iterations_ = 0;
  p_inverse(d);
  if (rows.size() == 0) return;
  normalise(rows, particles);
  gather(rows, d, residual_);
  for (int r = 0; r < rows.size(); ++r) residual_[r] -= scale_[r] * rows.target(r);
  const double goal = kTolerance * residual_.norm();
  direction_.setZero(rows.size());
  double last = 1.0;
  while (residual_.norm() > goal && iterations_ < kMaxIterations) {
    spread(rows, particles, residual_);
    p(moved_);
    gather(rows, moved_, preconditioned_);
    const double now = residual_.dot(preconditioned_);
    direction_ = preconditioned_ + (iterations_ == 0 ? 0.0 : now / last) * direction_;
    last = now;
    spread(rows, particles, direction_);
    p_inverse(moved_);
    gather(rows, moved_, product_);
    product_ += compliance_.cwiseProduct(direction_);
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0.0)) break;
    const double step = now / curvature;
    d -= step * moved_;
    residual_ -= step * product_;
    ++iterations_;
  }
}

}  // namespace pliant
