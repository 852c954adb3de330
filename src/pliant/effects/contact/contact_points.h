#pragma once

#include "pliant/core/body/embedded_points.h"
#include "pliant/core/system/constraint.h"

namespace pliant {

/// The points of a body that touch: its particles, or points that these carry. How they move and
/// what a force on one does to the particles.
class ContactPoints {
 public:
  /// `embedded` outlives this; null: the particles themselves.
  explicit ContactPoints(const EmbeddedPoints* embedded) : embedded_(embedded) {}

  const EmbeddedPoints* embedded() const { return embedded_; }
  bool are_embedded() const { return embedded_ != nullptr; }
  int size(const Particles& particles) const {
    return embedded_ ? embedded_->size() : particles.size();
  }
  /// Of all embedded points, 3 x n [m].
  void positions(const Positions& x, Eigen::Matrix3Xd& points) const {
    points.resize(3, embedded_->size());
    embedded_->positions(x, points);
  }
  Eigen::Vector3d position(const Positions& x, int point) const {
    return embedded_ ? embedded_->position(x, point) : Eigen::Vector3d(x.col(point));
  }
  /// Where a point would be after a step of `dt` [s] that no force changed [m].
  Eigen::Vector3d coasted(const Particles& particles, double dt, int point) const {
    const Positions& origin = particles.x_inertial();
    const Eigen::Matrix3Xd& velocity = particles.v_inertial();
    if (!embedded_) return origin.col(point) + dt * velocity.col(point);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const int i = embedded_->particles()(k, point);
      sum += embedded_->weights()(k, point) * (origin.col(i) + dt * velocity.col(i));
    }
    return sum;
  }
  /// Whether no particle that carries it can move.
  bool is_fixed(const Particles& particles, int point) const {
    if (!embedded_) return particles.is_fixed(point);
    for (int k = 0; k < 4; ++k) {
      if (!particles.is_fixed(embedded_->particles()(k, point))) return false;
    }
    return true;
  }
  /// How far a force of 1 N moves the point [m/N], for such `mobility` of the particles.
  double mobility(const Eigen::VectorXd& mobility, int point) const {
    if (!embedded_) return mobility[point];
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double w = embedded_->weights()(k, point);
      sum += w * w * mobility[embedded_->particles()(k, point)];
    }
    return sum;
  }
  /// Σ m Δx along a force on the point over that force, of particles of such `mobility` [kg m/N].
  double moved_mass(const Eigen::VectorXd& mobility, const Eigen::VectorXd& mass, int point) const {
    if (!embedded_) return mobility[point] * mass[point];
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int i = embedded_->particles()(k, point);
      sum += embedded_->weights()(k, point) * mobility[i] * mass[i];
    }
    return sum;
  }
  /// x += what `force` on the point does.
  void move(int point, const Eigen::Vector3d& force, const Eigen::VectorXd& mobility,
            Positions& x) const {
    if (!embedded_) {
      x.col(point) += mobility[point] * force;
      return;
    }
    for (int k = 0; k < 4; ++k) {
      const int i = embedded_->particles()(k, point);
      x.col(i) += embedded_->weights()(k, point) * mobility[i] * force;
    }
  }
  /// f += `force` on the point, shared out to the particles.
  void add_force(int point, const Eigen::Vector3d& force, Forces& f) const {
    if (!embedded_) {
      f.col(point) += force;
      return;
    }
    for (int k = 0; k < 4; ++k) {
      f.col(embedded_->particles()(k, point)) += embedded_->weights()(k, point) * force;
    }
  }
  /// Adds the particles of the point to the constraint that was appended last.
  void add_entries(int point, PointConstraints& constraints) const {
    if (!embedded_) return constraints.add(point, 1.0);
    for (int k = 0; k < 4; ++k) {
      constraints.add(embedded_->particles()(k, point), embedded_->weights()(k, point));
    }
  }
  /// Adds the gradient of `direction` . position to the row that was begun.
  void add_to_row(int point, const Eigen::Vector3d& direction, ConstraintRows& rows) const {
    if (!embedded_) {
      rows.add(point, direction);
      return;
    }
    for (int k = 0; k < 4; ++k) {
      rows.add(embedded_->particles()(k, point), embedded_->weights()(k, point) * direction);
    }
  }

 private:
  const EmbeddedPoints* embedded_;
};

}  // namespace pliant
