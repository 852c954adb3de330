#pragma once

#include "pliant/core/carried_points.h"
#include "pliant/core/coupling.h"

namespace pliant {

/// The points of a body that touch: its particles, or points that these carry. How they move and
/// what a force on one does to the particles.
class ContactPoints {
 public:
  /// `carried` outlives this; null: the particles themselves.
  explicit ContactPoints(const CarriedPoints* carried) : carried_(carried) {}

  const CarriedPoints* carried() const { return carried_; }
  bool are_carried() const { return carried_ != nullptr; }
  int size(const Particles& particles) const {
    return carried_ ? carried_->size() : particles.size();
  }
  /// Of all carried points, 3 x n [m].
  void positions(const Positions& x, Eigen::Matrix3Xd& points) const {
    points.resize(3, carried_->size());
    carried_->positions(x, points);
  }
  Eigen::Vector3d position(const Positions& x, int point) const {
    return carried_ ? carried_->position(x, point) : Eigen::Vector3d(x.col(point));
  }
  /// Whether no particle that carries it can move.
  bool is_fixed(const Particles& particles, int point) const {
    if (!carried_) return particles.is_fixed(point);
    for (int k = 0; k < 4; ++k) {
      if (!particles.is_fixed(carried_->particles()(k, point))) return false;
    }
    return true;
  }
  /// How far a force of 1 N moves the point [m/N], for such `mobility` of the particles.
  double mobility(const Eigen::VectorXd& mobility, int point) const {
    if (!carried_) return mobility[point];
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double w = carried_->weights()(k, point);
      sum += w * w * mobility[carried_->particles()(k, point)];
    }
    return sum;
  }
  /// Σ m Δx along a force on the point over that force, of particles of such `mobility` [kg m/N].
  double moved_mass(const Eigen::VectorXd& mobility, const Eigen::VectorXd& mass, int point) const {
    if (!carried_) return mobility[point] * mass[point];
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int i = carried_->particles()(k, point);
      sum += carried_->weights()(k, point) * mobility[i] * mass[i];
    }
    return sum;
  }
  /// x += what `force` on the point does.
  void move(int point, const Eigen::Vector3d& force, const Eigen::VectorXd& mobility,
            Positions& x) const {
    if (!carried_) {
      x.col(point) += mobility[point] * force;
      return;
    }
    for (int k = 0; k < 4; ++k) {
      const int i = carried_->particles()(k, point);
      x.col(i) += carried_->weights()(k, point) * mobility[i] * force;
    }
  }
  /// f += `force` on the point, shared out to the particles.
  void add_force(int point, const Eigen::Vector3d& force, Forces& f) const {
    if (!carried_) {
      f.col(point) += force;
      return;
    }
    for (int k = 0; k < 4; ++k) {
      f.col(carried_->particles()(k, point)) += carried_->weights()(k, point) * force;
    }
  }
  /// Adds the particles of the point to the constraint that was appended last.
  void add_entries(int point, PointConstraints& constraints) const {
    if (!carried_) return constraints.add(point, 1.0);
    for (int k = 0; k < 4; ++k) {
      constraints.add(carried_->particles()(k, point), carried_->weights()(k, point));
    }
  }
  /// Adds the gradient of `direction` . position to the row that was begun.
  void add_to_row(int point, const Eigen::Vector3d& direction, CouplingRows& rows) const {
    if (!carried_) {
      rows.add(point, direction);
      return;
    }
    for (int k = 0; k < 4; ++k) {
      rows.add(carried_->particles()(k, point), carried_->weights()(k, point) * direction);
    }
  }

 private:
  const CarriedPoints* carried_;
};

}  // namespace pliant
