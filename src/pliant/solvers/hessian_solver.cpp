#include "pliant/solvers/hessian_solver.h"

#include <Eigen/LU>
#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

constexpr int kMostIterations = 1000;

double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return parallel_sum(0, static_cast<int>(a.cols()), kColumnGrain,
                      [&](int i) { return a.col(i).dot(b.col(i)); });
}

}  // namespace

void HessianSolver::assemble(const ProjectiveSystem& system, const Positions& x,
                             const Eigen::VectorXd& inertia, Definiteness definiteness) {
  const Particles& particles = system.particles;
  if (!is_prepared_) matrix_ = BlockMatrix();
  do {
    matrix_.begin(particles, inertia);
    for (const auto& set : system.elements) set->add_stiffness(x, definiteness, matrix_);
  } while (!matrix_.finish());
  parallel_copy(x, x_);
  if (is_prepared_) return;
  coarse_.prepare(matrix_, particles);
  inverses_.resize(static_cast<std::size_t>(particles.size()));
  is_prepared_ = true;
}

void HessianSolver::factor() {
  const int n = matrix_.size();
  for (int i = 0; i < n; ++i) inverses_[static_cast<std::size_t>(i)] = matrix_.diagonal(i);
  for (int row = 0; row < rows_.size(); ++row) {
    for (const auto* e = rows_.begin(row); e != rows_.end(row); ++e) {
      inverses_[static_cast<std::size_t>(e->particle)] +=
          rows_.stiffness(row) * e->gradient * e->gradient.transpose();
    }
  }
  parallel_for(0, n, kColumnGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Eigen::Matrix3d& inverse = inverses_[static_cast<std::size_t>(i)];
      inverse = inverse.inverse().eval();
    }
  });
  coarse_.factor(matrix_, rows_, x_);
}

void HessianSolver::precondition(const Eigen::Matrix3Xd& r, Eigen::Matrix3Xd& z) {
  z.resize(3, r.cols());
  for_each_column(z, [&](int i) { z.col(i) = inverses_[static_cast<std::size_t>(i)] * r.col(i); });
  coarse_.add_correction(r, z);
}

bool HessianSolver::solve(double tolerance, Eigen::Matrix3Xd& v) {
  parallel_copy(v, residual_);
  parallel_zero(v.cols(), v);
  precondition(residual_, preconditioned_);
  double now = dot(residual_, preconditioned_);
  if (now < 0.0) return false;
  const double goal = tolerance * tolerance * now;
  parallel_copy(preconditioned_, direction_);
  for (iterations_ = 0; iterations_ < kMostIterations && now > goal; ++iterations_) {
    matrix_.multiply(direction_, product_);
    rows_.add_product(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0.0)) return false;
    const double step = now / curvature;
    for_each_column(v, [&](int i) {
      v.col(i) += step * direction_.col(i);
      residual_.col(i) -= step * product_.col(i);
    });
    precondition(residual_, preconditioned_);
    const double last = now;
    now = dot(residual_, preconditioned_);
    if (now < 0.0) return false;
    for_each_column(v, [&](int i) {
      direction_.col(i) = preconditioned_.col(i) + now / last * direction_.col(i);
    });
  }
  return true;
}

}  // namespace pliant
