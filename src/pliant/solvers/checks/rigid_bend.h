#pragma once

#include "pliant/solvers/components/rigid_modes.h"

namespace pliant {

/// How far contact forces bend rigid bodies that nothing holds. Solvers know such a body as a very
/// stiff cluster of particles, find contact in its bent shape and give it its own shape back at the
/// end of the step, so that all points that touch stand some micrometres too deep: no error, since
/// each step ends so. A cluster of stiffness k bends by
///   u = (f − M P (Pᵀ M P)⁻¹ Pᵀ f) / (k m),
/// f the forces on its particles, of masses M, and P its rigid motions.
class RigidBend {
 public:
  void prepare(const ProjectiveSystem& system, const Components& components);
  /// Whether there are rigid bodies.
  bool is_used() const { return is_used_; }
  /// u of the forces that the constraints have, at the positions `x`; 0 of all other particles [m].
  const Positions& find(const PointConstraints& constraints, const Positions& x);
  /// The gaps become those of the bent shapes, and the slips those of the bodies' own ones:
  /// friction takes back in the next step what a point came off by as it got its shape back.
  void bend(PointConstraints& constraints, const Positions& x);

 private:
  RigidModes modes_;
  Eigen::VectorXd stiffness_;  // k m of a rigid body's particle, else 0 [N/m]
  Positions bend_;
  bool is_used_ = false;
};

}  // namespace pliant
