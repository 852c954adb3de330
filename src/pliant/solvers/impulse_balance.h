#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <utility>
#include <vector>

#include "pliant/core/coupling.h"
#include "pliant/solvers/components.h"
#include "pliant/solvers/contact_response.h"
#include "pliant/solvers/rigid_mode.h"

namespace pliant {

/// Gives every connected component of a body the rigid motion that external and contact forces
/// demand, whatever an iterative solver left unbalanced inside of it. Internal forces add up to no
/// force and no torque, so of implicit Euler's equation what remains for the six rigid modes P is
///   Pᵀ (M (y − x)/h² + Jᵀf) = 0,  y the prediction, f the forces of contacts.
/// A correction by γ D⁻¹ r alone is far from it: in a stiff body it moves the whole by a small
/// share of what the forces demand, and contacts that answer with D⁻¹ feel forces that are too
/// large by the stiffness over the inertia.
///
/// Contacts are condensed onto the modes: each answers by its own compliance (contact_response.h),
/// and the modes of components that touch each other are found together, by a semismooth Newton
/// method with six unknowns a component. Then the change of momentum of a component, and of its
/// angular momentum, is the impulse of the forces that are reported, at any number of iterations.
///
/// This is done before the first correction and after the last one. In between it would disturb the
/// search for the inner forces: it changes each contact's force before they have answered.
class ImpulseBalance {
 public:
  void prepare(const ProjectiveSystem& system, double dt);
  /// Before the first correction, where positions are the prediction: what turns is predicted on
  /// straight lines, which stretch it; that stretch goes away again.
  void turn_prediction(ProjectiveSystem& system);
  /// Before the first correction, with the solver's `mobility` of the particles [m/N]: moves the
  /// components and lets contacts that couplings offer (Coupling::add_contacts) find their forces.
  void correct(ProjectiveSystem& system, const Eigen::VectorXd& mobility);
  /// After the last one: the same until the impulses balance to round-off.
  void finish(ProjectiveSystem& system, const Eigen::VectorXd& mobility);
  /// Largest share of a component's impulses that is out of balance at present. Of components that
  /// are tied to pinned particles nothing is known.
  double imbalance(const ProjectiveSystem& system);

 private:
  using Vector6 = rigid::Vector6;
  using Matrix6 = rigid::Matrix6;

  struct Mode : rigid::Mode {
    Vector6 balance;  // with the forces of contacts, as they were [N]
    Vector6 local;    // momentum, over h, that contacts' local displacements would hold [N]
    Vector6 motion;   // [m]
  };
  /// What a contact's point has of a component's motion.
  struct Side {
    int component = Components::kNone;
    double weight = 0.0;
    Eigen::Vector3d lever = Eigen::Vector3d::Zero();  // in radii of the component
  };
  struct Touch {
    double compliance = 0.0;  // 0: nothing that moves takes part
    Side sides[2];
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // that it had [N]
    ContactResponse now;                              // to the motions
    double bound = 0.0;                               // of its friction, where that is given [N]
  };
  /// A single particle has no inner forces that could be out of balance.
  bool takes_part(int component) const {
    return component != Components::kNone &&
           !components_.pinned[static_cast<std::size_t>(component)] &&
           components_.size(component) > 1;
  }
  bool is_possible(const ProjectiveSystem& system) const;
  void collect(const ProjectiveSystem& system);
  void find_forces(const ProjectiveSystem& system);
  void find_mode(const ProjectiveSystem& system, int component);
  void turn_prediction(Particles& particles, int component) const;
  void find_touches(const ProjectiveSystem& system, const Eigen::VectorXd& mobility);
  void find_islands();
  bool is_touched(int component) const {
    const auto c = static_cast<std::size_t>(component);
    return touch_begins_[c] < touch_begins_[c + 1];
  }
  void solve_islands(bool is_last);
  /// The motions of `count` components that touch each other, those of all others as they are.
  void solve(const int* components, std::size_t count);
  void begin_solving(const int* components, std::size_t count);
  bool newton(const int* components, std::size_t count);
  void advance(const int* components, std::size_t count, double share);
  double potential(const int* components, std::size_t count) const;  // [J]
  Eigen::Vector3d displacement(const Touch& touch) const;
  /// Of these components at the present motions; returns its largest part [N].
  double find_residual(const int* components, std::size_t count);
  void assemble(const int* components, std::size_t count, Eigen::MatrixXd& matrix);
  /// To the motion that its forces demand, or on from the present one by what `balance` has more.
  void push(Mode& mode, bool from_here) const;
  void take_forces();
  void give_way(const Particles& particles, const Eigen::VectorXd& mobility);
  void move(ProjectiveSystem& system, const Eigen::VectorXd& mobility);
  void give_back(ProjectiveSystem& system);
  bool contacts_hold() const;
  double worst() const;

  double dt_ = 0.0;
  bool is_needed_ = false, has_outer_ = false;
  Components components_;
  std::vector<int> large_;  // components whose sums threads share
  std::vector<Mode> modes_;
  Forces other_forces_;  // of couplings without contacts and of what holds from outside [N]
  bool has_other_forces_ = false;
  ContactRows rows_;
  std::vector<Touch> touches_;
  std::vector<int> shares_;        // contacts of each particle
  std::vector<int> island_of_;     // component that stands for its island
  std::vector<int> by_island_;     // components
  std::vector<int> touch_begins_;  // of each component's in touches_of_
  std::vector<int> touches_of_, next_;
  std::vector<int> place_;   // of a component among those that are solved; -1: not there
  std::vector<int> solved_;  // contacts
  std::vector<std::pair<int, Eigen::Vector3d>> local_;  // displacements of particles [m]
  Eigen::VectorXd residual_, step_, start_;
  double tolerance_ = 0.0;                       // of what is left of the forces
  bool is_coulomb_ = true;                       // or friction whose bounds are given
  static constexpr std::size_t kMostAtOnce = 8;  // components
  Eigen::MatrixXd matrices_[kMostAtOnce + 1];    // by their number
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_[kMostAtOnce + 1];
};

}  // namespace pliant
