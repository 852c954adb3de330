#include "pliant/solvers/checks/rigid_balance.h"

#include <algorithm>
#include <utility>

namespace pliant {

void RigidBalance::prepare(Components components, const Eigen::VectorXd& inertia) {
  modes_.prepare(std::move(components), inertia);
  const Eigen::Index size = is_used() ? 6 * modes_.count() : 0;
  matrix_.resize(size, size);
  sums_.resize(size);
}

void RigidBalance::place(const Eigen::VectorXd& mass, double scale, const Positions& x) {
  if (modes_.count() == 0) return;
  modes_.set_inertia(mass, scale);
  modes_.update(x);
}

void RigidBalance::factor(const HeldRows& rows) {
  if (!is_used()) return;
  matrix_.setZero();
  for (int b = 0; b < modes_.count(); ++b) {
    matrix_.block<6, 6>(6 * b, 6 * b) = modes_.inertia(b);
  }
  rows.for_each([&](int row) { add_row(rows, row); },
                [&](const HeldRows::Block& block) { add_block(rows, block); });
  // An axis without inertia and without contact has no motion: any number does.
  matrix_.diagonal().array() += 1e-14 * matrix_.diagonal().maxCoeff();
  factor_.compute(matrix_);
}

void RigidBalance::add_row(const HeldRows& rows, int row) {
  touched_.clear();
  for (const auto* e = rows.begin(row); e != rows.end(row); ++e) {
    const int body = modes_.body_of(e->particle);
    if (body < 0) continue;
    if (std::find(touched_.begin(), touched_.end(), body) == touched_.end()) {
      touched_.push_back(body);
      sums_.segment<6>(6 * body).setZero();
    }
    sums_.segment<6>(6 * body) += modes_.project(e->particle, e->gradient);
  }
  for (const int a : touched_) {
    for (const int b : touched_) {
      matrix_.block<6, 6>(6 * a, 6 * b) +=
          rows.stiffness(row) * sums_.segment<6>(6 * a) * sums_.segment<6>(6 * b).transpose();
    }
  }
}

void RigidBalance::add_block(const HeldRows& rows, const HeldRows::Block& block) {
  for (int a = 0; a < block.particles; ++a) {
    const int row = modes_.body_of(rows.particle(block, a));
    for (int b = 0; row >= 0 && b < block.particles; ++b) {
      const int column = modes_.body_of(rows.particle(block, b));
      if (column < 0) continue;
      matrix_.block<6, 6>(6 * row, 6 * column) += modes_.project(
          rows.particle(block, a), rows.stiffness(block, a, b), rows.particle(block, b));
    }
  }
}

bool RigidBalance::find_motion(Eigen::Matrix3Xd& z) {
  if (!is_used()) return false;
  const int n = static_cast<int>(z.cols());
  sums_.setZero();
  for (int i = 0; i < n; ++i) {
    const int body = modes_.body_of(i);
    if (body >= 0) sums_.segment<6>(6 * body) += modes_.project(i, z.col(i));
  }
  factor_.solve_in_place(sums_);
  for (int i = 0; i < n; ++i) {
    const int body = modes_.body_of(i);
    if (body < 0) {
      z.col(i).setZero();
    } else {
      z.col(i) = modes_.motion(i, sums_.segment<6>(6 * body));
    }
  }
  return true;
}

}  // namespace pliant
