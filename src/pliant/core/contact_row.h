#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

/// One contact of the running step, between a point of a body and an obstacle or between two points
/// of bodies, in the form in which a solver holds all contacts together. The point, or the
/// difference of both, is u = Σ weights[k] x[particles[k]].
struct ContactRow {
  static constexpr std::size_t kParticles = 8;

  std::size_t count = 0;  ///< of the particles
  std::array<int, kParticles> particles;
  std::array<double, kParticles> weights;
  Eigen::Vector3d normal;     ///< in which u must not fall below what it has to keep
  double gap = 0.0;           ///< what it keeps above that at the present positions [m]
  double rest = 0.0;          ///< by which the gap may be missed [m]
  Eigen::Vector3d slip;       ///< tangential displacement of u since the step began [m]
  double friction = 0.0;      ///< Coulomb's coefficient, static and dynamic
  double adhesion = 0.0;      ///< pull that it withstands [N]
  double normal_force = 0.0;  ///< multiplier, >= -adhesion [N]
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< multiplier, tangential [N]

  Eigen::Vector3d force() const { return normal_force * normal + friction_force; }
  /// Largest friction force for a normal force [N]. What pulls presses as well (Derjaguin 1934).
  double friction_bound(double normal) const { return friction * std::max(0.0, normal + adhesion); }
  bool carries_force() const { return normal_force != 0.0 || !friction_force.isZero(0.0); }
};

/// Receives contacts, and gives them back in the same order with their new multipliers. Reused, so
/// that it allocates nothing once it is warm.
class ContactRows {
 public:
  void clear() { rows_.clear(), next_ = 0; }
  ContactRow& add() { return rows_.emplace_back(); }
  /// The next row, in the order of add().
  const ContactRow& take() { return rows_[next_++]; }

  std::vector<ContactRow>& all() { return rows_; }
  const std::vector<ContactRow>& all() const { return rows_; }

 private:
  std::vector<ContactRow> rows_;
  std::size_t next_ = 0;
};

}  // namespace pliant
