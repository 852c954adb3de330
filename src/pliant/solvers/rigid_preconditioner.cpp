#include "pliant/solvers/rigid_preconditioner.h"

namespace pliant {
namespace {
// Of which the dense matrix of their motions is worth its factor.
constexpr int kMostBodies = 24;
}  // namespace

void RigidPreconditioner::add_motion(int body, const Vector6& motion, Row& row) {
  for (int k = 0; k < 2; ++k) {
    if (row.bodies[k] >= 0 && row.bodies[k] != body) continue;
    row.bodies[k] = body;
    row.motions[k] += motion;
    return;
  }
}

void RigidPreconditioner::prepare(const ConstraintRows& rows, const Eigen::VectorXd& mobility,
                                  const RigidModes& modes) {
  rows_.resize(static_cast<std::size_t>(rows.size()));
  has_bodies_ = modes.count() > 0 && modes.count() <= kMostBodies;
  const Eigen::Index size = has_bodies_ ? 6 * modes.count() : 0;
  matrix_.setZero(size, size);
  sums_.resize(size);
  for (int b = 0; has_bodies_ && b < modes.count(); ++b) {
    matrix_.block<6, 6>(6 * b, 6 * b) = modes.inertia(b);
  }
  for (int r = 0; r < rows.size(); ++r) {
    Row& row = rows_[static_cast<std::size_t>(r)];
    row = {};
    double own = rows.compliance(r);
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      const double reach = mobility[entry->particle];
      if (reach == 0.0) continue;  // pinned
      own += reach * entry->weight * entry->weight;
      const int body = modes.body_of(entry->particle);
      if (!has_bodies_ || body < 0) continue;
      add_motion(body, modes.project(entry->particle, entry->weight * rows.direction(r)), row);
    }
    row.inverse = own > 0.0 ? 1.0 / own : 0.0;
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        if (row.bodies[a] < 0 || row.bodies[b] < 0) continue;
        matrix_.block<6, 6>(6 * row.bodies[a], 6 * row.bodies[b]) +=
            row.inverse * row.motions[a] * row.motions[b].transpose();
      }
    }
  }
  if (!has_bodies_) return;
  // An axis without inertia and without contact has no motion: any number does.
  matrix_.diagonal().array() += 1e-14 * matrix_.diagonal().maxCoeff();
  factor_.compute(matrix_);
}

void RigidPreconditioner::apply(const Eigen::VectorXd& residual, Eigen::VectorXd& preconditioned) {
  sums_.setZero();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const auto k = static_cast<Eigen::Index>(r);
    preconditioned[k] = row.inverse * residual[k];
    for (int b = 0; b < 2; ++b) {
      if (row.bodies[b] < 0) continue;
      sums_.segment<6>(6 * row.bodies[b]) += preconditioned[k] * row.motions[b];
    }
  }
  if (!has_bodies_) return;
  factor_.solveInPlace(sums_);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    for (int b = 0; b < 2; ++b) {
      if (row.bodies[b] < 0) continue;
      preconditioned[static_cast<Eigen::Index>(r)] -=
          row.inverse * row.motions[b].dot(sums_.segment<6>(6 * row.bodies[b]));
    }
  }
}

}  // namespace pliant
