#pragma once

#include <vector>

#include "pliant/core/system/point_constraint.h"
#include "pliant/solvers/components/rigid_modes.h"

namespace pliant {

/// Contacts between components that move as rigid bodies, each solved in its turn until none
/// changes much (nonlinear Gauss-Seidel: Moreau 1988, Jean 1999): forces
///   λ = Π(λ0 − (g + J y)/C),  y = (Pᵀ M P / h²)⁻¹ (s + Jᵀ λ),
/// of gaps and slips g, motions y, and sums s of all other forces and torques; Π is the projection
/// onto what a force may be (above the lowest; Coulomb's disk of the present normal force). It
/// converges slowly where many contacts share a load, but from anywhere, and wherever it stops the
/// forces are such as may be and the motions are those that they give.
class CondensedContacts {
 public:
  /// Begins with the sums s [N, N m], six numbers of each component.
  void begin(const Eigen::VectorXd& sums);
  /// The next constraint, C of it [m/N]; `add` then names its particles.
  void append(const PointConstraint& constraint, double compliance);
  /// `weight` of a particle in the constraint that was appended last; those of no component are
  /// left out.
  void add(const RigidModes& modes, int particle, double weight);
  /// Finds all forces.
  void solve(const RigidModes& modes);

  const Eigen::VectorXd& motions() const { return motions_; }  ///< y [m, rad]
  double normal_force(std::size_t c) const { return contacts_[c].normal_force; }
  const Eigen::Vector3d& friction_force(std::size_t c) const { return contacts_[c].friction_force; }

 private:
  using Gradient = Eigen::Matrix<double, 6, 3>;
  struct Contact {
    std::size_t begin = 0, end = 0;  // of its sides
    double gap = 0.0, lowest = 0.0, friction = 0.0, compliance = 0.0;
    Eigen::Vector3d normal, slip;
    double kept_normal = 0.0;       // λ0
    Eigen::Vector3d kept_friction;  // λ0
    double normal_force = 0.0;
    Eigen::Vector3d friction_force;
    double normal_answer = 0.0, tangent_answer = 0.0;  // of the point to a force [m/N]
  };
  struct Side {
    int body = 0;
    Gradient gradient = Gradient::Zero();  // Jᵀ
    Gradient answer = Gradient::Zero();    // (Pᵀ M P / h²)⁻¹ Jᵀ
  };

  void prepare(const RigidModes& modes);
  Eigen::Vector3d displacement(const Contact& contact) const;
  void push(const Contact& contact, const Eigen::Vector3d& force);
  /// Returns by how much its force changes [N].
  double relax(Contact& contact);

  std::vector<Contact> contacts_;
  std::vector<Side> sides_;
  Eigen::VectorXd sums_, motions_;
};

}  // namespace pliant
