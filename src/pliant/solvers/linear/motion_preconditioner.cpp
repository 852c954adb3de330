#include "pliant/solvers/linear/motion_preconditioner.h"

#include <algorithm>

#include "pliant/core/system/responding_system.h"

namespace pliant {
namespace {

using Vector6 = RigidModes::Vector6;

// Of which the dense matrix of their motions is worth its factor.
constexpr int kMostBodies = 24;

int responder_of(const std::vector<ProjectiveSystem::Responder>& responders, int particle) {
  for (std::size_t k = 0; k < responders.size(); ++k) {
    if (responders[k].has(particle)) return static_cast<int>(k);
  }
  return -1;
}

}  // namespace

void MotionPreconditioner::list_movers(const RigidModes& modes,
                                       const std::vector<ProjectiveSystem::Responder>& responders) {
  components_ = modes.count() <= kMostBodies ? modes.count() : 0;
  movers_.assign(static_cast<std::size_t>(components_), {});
  Eigen::Index size = 0;
  for (Unknowns& mover : movers_) {
    mover = {size, 6};
    size += 6;
  }
  for (const auto& responder : responders) {
    movers_.push_back({size, responder.system->inverse_response().rows()});
    size += movers_.back().size;
  }
  matrix_.setZero(size, size);
  sums_.resize(size);
  for (int b = 0; b < components_; ++b) {
    matrix_.block<6, 6>(6 * b, 6 * b) = modes.inertia(b);
  }
  for (std::size_t k = 0; k < responders.size(); ++k) {
    const Unknowns& own = movers_[static_cast<std::size_t>(components_) + k];
    matrix_.block(own.begin, own.begin, own.size, own.size) =
        responders[k].system->inverse_response();
  }
}

double* MotionPreconditioner::motion_of(int mover, Row& row) {
  for (int k = 0; k < 2; ++k) {
    if (row.movers[k] >= 0 && row.movers[k] != mover) continue;
    if (row.movers[k] < 0) {
      row.movers[k] = mover;
      row.motions[k] = motions_.size();
      const auto size = static_cast<std::size_t>(movers_[static_cast<std::size_t>(mover)].size);
      motions_.resize(motions_.size() + size, 0.0);
    }
    return motions_.data() + row.motions[k];
  }
  return nullptr;
}

MotionPreconditioner::ConstMotion MotionPreconditioner::motion(const Row& row, int k) const {
  const Unknowns& mover = movers_[static_cast<std::size_t>(row.movers[k])];
  return {motions_.data() + row.motions[k], mover.size};
}

RigidModes::Vector6 MotionPreconditioner::rigid_motion(const Row& row, int k) const {
  return Eigen::Map<const Vector6>{motions_.data() + row.motions[k]};
}

void MotionPreconditioner::add_row(const Row& row) {
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      if (row.movers[a] < 0 || row.movers[b] < 0) continue;
      const Unknowns& of_a = movers_[static_cast<std::size_t>(row.movers[a])];
      const Unknowns& of_b = movers_[static_cast<std::size_t>(row.movers[b])];
      matrix_.block(of_a.begin, of_b.begin, of_a.size, of_b.size) +=
          (row.inverse * motion(row, a)).lazyProduct(motion(row, b).transpose());
    }
  }
}

void MotionPreconditioner::prepare(const PointConstraintRows& rows, const Eigen::VectorXd& answers,
                                   const RigidModes& modes,
                                   const std::vector<ProjectiveSystem::Responder>& responders) {
  list_movers(modes, responders);
  motions_.clear();
  rows_.resize(static_cast<std::size_t>(rows.size()));
  for (int r = 0; r < rows.size(); ++r) {
    Row& row = rows_[static_cast<std::size_t>(r)];
    row = {};
    double own = rows.compliance(r);
    for (const auto* entry = rows.begin(r); entry != rows.end(r); ++entry) {
      const double reach = answers[entry->particle];
      if (reach == 0.0) continue;  // pinned
      const Eigen::Vector3d direction = entry->weight * rows.direction(r);
      if (const int k = responder_of(responders, entry->particle); k >= 0) {
        const auto& responder = responders[static_cast<std::size_t>(k)];
        const int mover = components_ + k;
        const Eigen::Index size = movers_[static_cast<std::size_t>(mover)].size;
        double* to = motion_of(mover, row);
        if (to == nullptr) continue;
        gradient_.setZero(size, 3);
        responder.system->add_rows(entry->particle - responder.begin, 1.0, gradient_);
        Eigen::Map<Eigen::VectorXd>(to, size) += gradient_.lazyProduct(direction);
        continue;
      }
      own += reach * entry->weight * entry->weight;
      const int body = modes.body_of(entry->particle);
      if (components_ == 0 || body < 0) continue;
      if (double* to = motion_of(body, row)) {
        Eigen::Map<Vector6>{to} += modes.project(entry->particle, direction);
      }
    }
    row.inverse = own > 0.0 ? 1.0 / own : 0.0;
    add_row(row);
  }
  if (movers_.empty()) return;
  // An axis without inertia and without contact has no motion: any number does.
  matrix_.diagonal().array() += 1e-14 * matrix_.diagonal().maxCoeff();
  factor_.compute(matrix_);
}

void MotionPreconditioner::apply(const Eigen::VectorXd& residual, Eigen::VectorXd& preconditioned) {
  sums_.setZero();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const auto k = static_cast<Eigen::Index>(r);
    preconditioned[k] = row.inverse * residual[k];
    for (int m = 0; m < 2; ++m) {
      if (row.movers[m] < 0) continue;
      const Unknowns& mover = movers_[static_cast<std::size_t>(row.movers[m])];
      if (mover.size == 6) {
        sums_.segment<6>(mover.begin) += preconditioned[k] * rigid_motion(row, m);
      } else {
        sums_.segment(mover.begin, mover.size) += preconditioned[k] * motion(row, m);
      }
    }
  }
  if (movers_.empty()) return;
  factor_.solve_in_place(sums_);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    for (int m = 0; m < 2; ++m) {
      if (row.movers[m] < 0) continue;
      const Unknowns& mover = movers_[static_cast<std::size_t>(row.movers[m])];
      const double along = mover.size == 6
                               ? rigid_motion(row, m).dot(sums_.segment<6>(mover.begin))
                               : motion(row, m).dot(sums_.segment(mover.begin, mover.size));
      preconditioned[static_cast<Eigen::Index>(r)] -= row.inverse * along;
    }
  }
}

}  // namespace pliant
