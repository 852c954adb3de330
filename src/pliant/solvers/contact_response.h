#pragma once

#include <Eigen/Core>
#include <cmath>

#include "pliant/core/contact_row.h"
#include "pliant/math/host_device.h"

namespace pliant {

/// How a contact that gives way by `compliance` w [m/N] answers a displacement u of its point, f⁰
/// being its multipliers so far:
///   f_n = max(−adhesion, f_n⁰ − (gap + n·u)/w),
///   f_t = f_t⁰ − (slip + u_t)/w, cut to a disk.
/// Signorini's and Coulomb's laws hold where no such step changes the forces any more (augmented
/// Lagrangian; Alart and Curnier 1991), the disk being that of the new f_n. With a disk that is
/// given instead (Tresca's friction) f is the gradient of a convex potential. `Row`: a ContactRow,
/// or what a device has of one.
class ContactResponse {
 public:
  ContactResponse() = default;
  /// Coulomb's: the disk of the new normal force.
  template <class Row>
  PLIANT_HOST_DEVICE ContactResponse(const Row& row, double compliance, const Eigen::Vector3d& u)
      : ContactResponse(row, compliance, u, 0.0) {
    bound_ = row.friction_bound(normal_force);
    rub();
  }
  /// Tresca's: a disk of the radius `bound` [N].
  template <class Row>
  PLIANT_HOST_DEVICE static ContactResponse with_bound(const Row& row, double compliance,
                                                       const Eigen::Vector3d& u, double bound) {
    ContactResponse response(row, compliance, u, bound);
    response.rub();
    return response;
  }

  double normal_force = 0.0;                                 ///< [N]
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< [N]

  template <class Row>
  PLIANT_HOST_DEVICE Eigen::Vector3d force(const Row& row) const {
    return normal_force * row.normal + friction_force;
  }
  /// −∂f/∂u [N/m]; not symmetric where a point slides under Coulomb's law.
  template <class Row>
  PLIANT_HOST_DEVICE Eigen::Matrix3d stiffness(const Row& row, bool is_coulomb) const {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d along = row.normal * row.normal.transpose();
    const bool is_closed = wanted_ > -row.adhesion;
    if (is_closed) result += along / compliance_;
    if (bound_ <= 0.0) return result;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along;
    if (sticks()) return result + across / compliance_;
    const Eigen::Vector3d t = held_back_ / length_;
    result += bound_ / length_ * (across - t * t.transpose());
    if (is_coulomb && is_closed) result -= row.friction / compliance_ * t * row.normal.transpose();
    return result;
  }
  /// Of which f = −∂ψ/∂u under Tresca's law [J].
  template <class Row>
  PLIANT_HOST_DEVICE double potential(const Row& row) const {
    const double below = wanted_ + row.adhesion;
    const double beyond = below < 0.0 ? below : 0.0;
    const double normal =
        0.5 * compliance_ * normal_force * normal_force - compliance_ * row.adhesion * beyond;
    if (bound_ <= 0.0) return normal;
    return normal + (sticks() ? 0.5 * length_ * length_ / compliance_
                              : bound_ * length_ - 0.5 * bound_ * bound_ * compliance_);
  }

 private:
  template <class Row>
  PLIANT_HOST_DEVICE ContactResponse(const Row& row, double compliance, const Eigen::Vector3d& u,
                                     double bound)
      : compliance_(compliance), bound_(bound) {
    const double along = row.normal.dot(u);
    wanted_ = row.normal_force - (row.gap + along) / compliance;
    normal_force = -row.adhesion < wanted_ ? wanted_ : -row.adhesion;
    held_back_ = row.slip + u - along * row.normal - compliance * row.friction_force;
    length_ = held_back_.norm();
  }
  PLIANT_HOST_DEVICE bool sticks() const { return length_ <= bound_ * compliance_; }
  PLIANT_HOST_DEVICE void rub() {
    if (bound_ <= 0.0) return;
    friction_force = -(sticks() ? 1.0 / compliance_ : bound_ / length_) * held_back_;
  }

  double compliance_ = 0.0, bound_ = 0.0;
  double wanted_ = 0.0;                                  // f_n, were there no bound to it [N]
  Eigen::Vector3d held_back_ = Eigen::Vector3d::Zero();  // −w times f_t, were it not cut [m]
  double length_ = 0.0;
};

}  // namespace pliant
