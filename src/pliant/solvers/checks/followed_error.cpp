#include "pliant/solvers/checks/followed_error.h"

#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

// Time in which what holds a particle takes back what that is off [s]. The true particle comes to
// rest there too, but it is not thrown there: pulled back at once it would keep that velocity.
constexpr double kSettling = 0.05;

}  // namespace

void FollowedError::turn(const RigidTurns& turns) {
  if (off_.cols() == 0) return;
  turns.apply(off_);
  turns.apply(gained_);
}

void FollowedError::fade(double seconds) {
  const double share = std::exp(-seconds / kHorizon);
  off_ *= share;
  gained_ *= share;
}

bool FollowedError::follow(HessianSolver& hessian, const Missed& missed, double steps,
                           double missing, double tolerance) {
  const Eigen::Index size = missed.force.cols();
  if (off_.cols() != size) {
    off_.setZero(3, size);
    gained_.setZero(3, size);
  }
  fade(steps * missed.dt);
  settled_ = 1.0 - std::exp(-steps * missed.dt / kSettling);
  const double solved = missed.are_doubled ? 0.5 * steps : steps;
  find_forces(hessian, missed, solved, missing * solved / steps);
  bool is_solved = hessian.solve(tolerance, move_);
  iterations_ = hessian.iterations();
  if (is_solved && add_friction(hessian.rows(), missed)) {
    is_solved = hessian.solve(tolerance, friction_);
    iterations_ += hessian.iterations();
    move_ += friction_;
  }
  if (!is_solved) return false;
  off_ += (steps / solved) * move_;
  // The velocity at the middle is the mean of those at both ends.
  gained_ *= missed.are_doubled ? -1.0 : 0.0;
  gained_ += (missed.are_doubled ? 2.0 : 1.0) / solved * move_;
  return true;
}

void FollowedError::keep(Positions& off, Eigen::Matrix3Xd& gained) const {
  if (off_.cols() == off.cols()) {
    off = off_;
    gained = gained_;
  } else {
    // Nothing is off yet.
    off.setZero();
    gained.setZero();
  }
}

void FollowedError::go_back_to(const Positions& off, const Eigen::Matrix3Xd& gained) {
  off_ = off;
  gained_ = gained;
}

void FollowedError::find_forces(const HessianSolver& hessian, const Missed& missed, double steps,
                                double missing) {
  // On the displacement u of what is off: (M/T² + K + Jᵀ S J) u = f + M/T² T ė − K e − Jᵀ S J e,
  // the last where J holds places, not velocities.
  hessian.multiply(off_, move_);
  const double share = 1.0 / (steps * steps);
  for_each_column(move_, [&](int i) {
    if (missed.mobility[i] == 0.0) {
      move_.col(i).setZero();
      return;
    }
    move_.col(i) = missing / steps * missed.force.col(i) - move_.col(i) +
                   share * missed.inertia[i] * (off_.col(i) + steps * gained_.col(i));
  });
  const HeldRows& held = hessian.rows();
  for (int r = 0; r < held.size(); ++r) {
    if (r < missed.rows.size() && !missed.rows.is_normal(r)) continue;
    held.add_scaled(r, -settled_ * held.stiffness(r) * held.along(r, off_), move_);
  }
}

bool FollowedError::add_friction(const HeldRows& held, const Missed& missed) {
  // Where a point slides, friction is as much larger as the normal force is: no row says so, since
  // such a matrix would not be symmetric.
  const PointConstraintRows& rows = missed.rows;
  bool slides = false;
  for (int r = 0; r + 1 < rows.size(); ++r) {
    const int c = rows.constraint(r);
    if (!rows.is_normal(r) || rows.constraint(r + 1) != c) continue;
    if (r + 2 < rows.size() && rows.constraint(r + 2) == c) continue;  // it sticks
    if (!slides) friction_.setZero(3, off_.cols());
    slides = true;
    const auto& constraint = missed.constraints.all[static_cast<std::size_t>(c)];
    const Eigen::Vector3d along = rows.direction(r + 1).cross(constraint.normal);
    const double pushed = held.along(r, move_) + settled_ * held.along(r, off_);
    const double force = -constraint.friction * held.stiffness(r) * pushed;
    for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
      if (missed.mobility[e->particle] == 0.0) continue;
      friction_.col(e->particle) += e->weight * force * along;
    }
  }
  return slides;
}

void FollowedError::save(StateArchive& numbers) const {
  numbers.write(static_cast<double>(off_.cols()));
  numbers.write_all(off_);
  if (off_.cols() > 0) numbers.write_all(gained_);
}

void FollowedError::load(StateArchive& numbers) {
  const double size = numbers.read();
  begin();
  // That of a solver that saved less is no number.
  if (!(size > 0.0 && size < static_cast<double>(numbers.size()))) return;
  off_.resize(3, static_cast<Eigen::Index>(size));
  gained_.resize(3, off_.cols());
  numbers.read_all(off_);
  numbers.read_all(gained_);
}

}  // namespace pliant
