#pragma once

#include <vector>

#include "pliant/core/system/responding_system.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// Impulses at a step's end that stop the normal velocity and the slip of points which touch a body
/// of coordinates (responding_system.h): where a force that acts all through a step ends the path
/// of such a body, its integrator, which keeps energy, would let it bounce. They act in the metric
/// of the mass, h λ + ν >= 0, |h λ_t + ν_t| <= μ (h λ + ν), and so take energy or none.
class ContactImpulses {
 public:
  using Responder = ProjectiveSystem::Responder;

  /// Finds them, and adds them to the velocities of the group's particles, to the momenta of the
  /// responders and, as forces over `dt` [s], to the multipliers of the constraints.
  void apply(const std::vector<Responder>& responders, const std::vector<Constraint*>& constraints,
             double dt, Particles& particles);

 private:
  struct Row {
    std::size_t constraint = 0;
    Eigen::Matrix3d axes;                              // columns: the normal and two tangents
    Eigen::Vector3d force;                             // of the step, along them [N]
    Eigen::Vector3d impulse;                           // along them [N s]
    double normal_answer = 0.0, tangent_answer = 0.0;  // [1/kg]
  };
  struct Side {
    Responder responder;
    Eigen::MatrixXd gradients;  // Uᵀ along the axes: three columns a row, room for more
    Eigen::VectorXd impulses;   // on the coordinates [kg^½ m/s]
  };

  void list_rows(const std::vector<Responder>& responders);
  void list_sides(const std::vector<Responder>& responders);
  void find_answers(Row& row, Eigen::Index column, const Particles& particles) const;
  /// Of the point along its axes [m/s].
  Eigen::Vector3d velocity(const Row& row, Eigen::Index column, const Particles& particles) const;
  void push(const Row& row, Eigen::Index column, const Eigen::Vector3d& impulse,
            Particles& particles);
  /// Returns by how much that changes the point's velocity [m/s].
  double relax(Row& row, Eigen::Index column, double dt, Particles& particles);
  void tell(const std::vector<Constraint*>& constraints, double dt);

  PointConstraints constraints_;
  std::vector<Row> rows_;
  std::vector<Side> sides_;
  Eigen::MatrixXd along_;  // of a row
};

}  // namespace pliant
