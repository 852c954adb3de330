#include "pliant/solvers/constrained/contact_impulses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Sweeps over all rows at the most, and the change of a velocity, as a share of the largest one,
// that ends them.
constexpr int kMaxSweeps = 100;
constexpr double kSmall = 1e-8;

bool is_of_any(const std::vector<ContactImpulses::Responder>& responders, int particle) {
  return std::any_of(responders.begin(), responders.end(),
                     [&](const auto& responder) { return responder.has(particle); });
}

/// Largest eigenvalue of the lower right 2x2 block.
double largest_tangential(const Eigen::Matrix3d& m) {
  return 0.5 * (m(1, 1) + m(2, 2)) + std::hypot(0.5 * (m(1, 1) - m(2, 2)), m(1, 2));
}

}  // namespace

void ContactImpulses::list_rows(const std::vector<Responder>& responders) {
  rows_.clear();
  for (std::size_t c = 0; c < constraints_.all.size(); ++c) {
    const PointConstraint& constraint = constraints_.all[c];
    if (!(constraint.normal_force > 0.0)) continue;
    const auto begin = constraints_.entries.begin();
    const bool touches =
        std::any_of(begin + constraint.begin, begin + constraint.end,
                    [&](const auto& entry) { return is_of_any(responders, entry.particle); });
    if (!touches) continue;
    Row row;
    row.constraint = c;
    row.axes.col(0) = constraint.normal;
    row.axes.col(1) = constraint.normal.unitOrthogonal();
    row.axes.col(2) = constraint.normal.cross(row.axes.col(1));
    row.force = row.axes.transpose() * constraint.friction_force;
    row.force[0] = constraint.normal_force;
    row.impulse.setZero();
    rows_.push_back(row);
  }
}

void ContactImpulses::list_sides(const std::vector<Responder>& responders) {
  sides_.resize(responders.size());
  const auto columns = static_cast<Eigen::Index>(3 * rows_.size());
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    Side& side = sides_[s];
    side.responder = responders[s];
    const Eigen::Index rank = side.responder.system->momenta().size();
    side.impulses.setZero(rank);
    if (side.gradients.cols() < columns) side.gradients.resize(rank, 2 * columns);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const PointConstraint& constraint = constraints_.all[rows_[r].constraint];
      along_.setZero(rank, 3);
      for (int e = constraint.begin; e < constraint.end; ++e) {
        const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
        if (!side.responder.has(entry.particle)) continue;
        side.responder.system->add_rows(entry.particle - side.responder.begin, entry.weight,
                                        along_);
      }
      side.gradients.middleCols<3>(static_cast<Eigen::Index>(3 * r)) =
          along_.lazyProduct(rows_[r].axes);
    }
  }
}

void ContactImpulses::find_answers(Row& row, Eigen::Index column,
                                   const Particles& particles) const {
  const PointConstraint& constraint = constraints_.all[row.constraint];
  double answer = 0.0;
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
    answer += entry.weight * entry.weight * particles.inverse_mass[entry.particle];
  }
  Eigen::Matrix3d all = answer * Eigen::Matrix3d::Identity();
  for (const Side& side : sides_) {
    const auto gradient = side.gradients.middleCols<3>(column);
    all += gradient.transpose().lazyProduct(gradient);
  }
  row.normal_answer = all(0, 0);
  row.tangent_answer = largest_tangential(all);
}

Eigen::Vector3d ContactImpulses::velocity(const Row& row, Eigen::Index column,
                                          const Particles& particles) const {
  const PointConstraint& constraint = constraints_.all[row.constraint];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
    const bool is_own = std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
      return side.responder.has(entry.particle);
    });
    if (!is_own) sum += entry.weight * particles.v.col(entry.particle);
  }
  sum = (row.axes.transpose() * sum).eval();
  for (const Side& side : sides_) {
    sum += side.gradients.middleCols<3>(column).transpose().lazyProduct(
        side.responder.system->momenta());
  }
  return sum;
}

void ContactImpulses::push(const Row& row, Eigen::Index column, const Eigen::Vector3d& impulse,
                           Particles& particles) {
  const PointConstraint& constraint = constraints_.all[row.constraint];
  const Eigen::Vector3d in_space = row.axes * impulse;
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
    particles.v.col(entry.particle) +=
        entry.weight * particles.inverse_mass[entry.particle] * in_space;
  }
  for (Side& side : sides_) {
    const auto gradient = side.gradients.middleCols<3>(column);
    side.responder.system->momenta() += gradient.lazyProduct(impulse);
    side.impulses += gradient.lazyProduct(impulse);
  }
}

double ContactImpulses::relax(Row& row, Eigen::Index column, double dt, Particles& particles) {
  if (row.normal_answer == 0.0) return 0.0;
  const double friction = constraints_.all[row.constraint].friction;
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  change[0] = std::max(-velocity(row, column, particles)[0] / row.normal_answer,
                       -(dt * row.force[0] + row.impulse[0]));
  push(row, column, change, particles);
  row.impulse += change;
  double moved = row.normal_answer * std::abs(change[0]);
  if (friction == 0.0) return moved;
  const Eigen::Vector2d held = (dt * row.force + row.impulse).tail<2>();
  Eigen::Vector2d goal = held - velocity(row, column, particles).tail<2>() / row.tangent_answer;
  const double bound = friction * (dt * row.force[0] + row.impulse[0]), size = goal.norm();
  if (size > bound) goal *= bound / size;
  change << 0.0, goal - held;
  push(row, column, change, particles);
  row.impulse += change;
  return std::max(moved, row.tangent_answer * change.norm());
}

void ContactImpulses::tell(const std::vector<Constraint*>& constraints, double dt) {
  for (const Row& row : rows_) {
    PointConstraint& constraint = constraints_.all[row.constraint];
    constraint.normal_force += row.impulse[0] / dt;
    constraint.friction_force += row.axes.rightCols<2>() * row.impulse.tail<2>() / dt;
  }
  for (Constraint* constraint : constraints) {
    if (constraint->tells_point_constraints()) constraint->take_multipliers(constraints_);
  }
}

void ContactImpulses::apply(const std::vector<Responder>& responders,
                            const std::vector<Constraint*>& constraints, double dt,
                            Particles& particles) {
  constraints_.clear();
  for (Constraint* constraint : constraints) {
    if (constraint->tells_point_constraints())
      constraint->add_point_constraints(particles.x, constraints_);
  }
  list_rows(responders);
  list_sides(responders);
  double fastest = 0.0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const auto column = static_cast<Eigen::Index>(3 * r);
    find_answers(rows_[r], column, particles);
    fastest = std::max(fastest, velocity(rows_[r], column, particles).norm());
  }
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double moved = 0.0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      moved = std::max(moved, relax(rows_[r], static_cast<Eigen::Index>(3 * r), dt, particles));
    }
    if (moved <= kSmall * fastest) break;
  }
  for (const Side& side : sides_) side.responder.system->take_impulses(side.impulses, dt);
  tell(constraints, dt);
}

}  // namespace pliant
