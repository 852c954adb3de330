#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/effects/contact/friction.h"
#include "pliant/models/reduced/reduced_response.h"
#include "pliant/models/reduced/reduced_vertices.h"

namespace pliant {

/// Contact of a reduced body with obstacles, at the end of each step.
///
/// An integrator makes its step with the contact forces g of the step before, as a guess. They are
/// then taken back to first order, q -= C g with the integrator's own response C, and the contacts
/// of the free motion are found. With rows a = Uᵀ n, and two tangents each, projected Gauss-Seidel
/// finds the forces that hold every point out of its obstacle and slow its slip, within the cone of
/// friction:
///   q += C a λ,  p += C' a λ,  0 <= n·x - plane ⊥ λ >= 0,  |λ_t| <= μ λ.
/// For a linear body this is the step that the integrator would have made under that force, so
/// that at rest nothing moves, and with an energy-keeping integrator an obstacle at rest takes
/// energy or nothing. Impulses then stop the normal velocity and the slip of what touches, in the
/// metric of the mass, p += a ν, with the cone over both: contact does not bounce.
///
/// Forces of other bodies may move the free body while contacts are held: shift() and hold() take
/// turns until both are found.
///
/// Each contact is a little soft, by kSoftness of the most mobile one's C, so that forces stay
/// bounded where more points touch than the coordinates can hold.
class ReducedContact {
 public:
  /// Both outlive this; `points` are what touches.
  ReducedContact(const ReducedVertices& vertices, const EmbeddedPoints& points);
  /// Uᵀ of the forces in the last step [kg^½ m/s²].
  const Eigen::VectorXd& guess() const { return guess_; }

  struct Step {
    double h;
    const ReducedResponse& response;
    const Eigen::VectorXd& q_start;
    ContactEffect& effect;
    const FrictionEffect* friction;  ///< may be null
  };
  /// Takes back the guess from q and p of `system`, whose particles are at the step's beginning,
  /// and finds its contacts. Positions of the particles follow.
  void begin(const Step& step, ReducedSystem& system);
  /// Other forces moved the free body by `displacement` more.
  void shift(const Eigen::VectorXd& displacement);
  /// Puts right q and the forces of the contacts. Positions of the particles follow. May be called
  /// again after more forces; goes on from the forces that it found.
  void hold(const Step& step, ReducedSystem& system);
  /// Puts right p, which other forces have changed before, and tells the forces to the effect.
  void end(const Step& step, ReducedSystem& system);
  /// After end(): others changed p, so that contacts stop it anew.
  void stop(const Step& step, ReducedSystem& system);
  void reset();
  void begin_step();
  void undo_step();
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  struct Touch {  // what the next step begins with
    int obstacle, point;
    double normal_force;             // [N]
    Eigen::Vector3d friction_force;  // [N]
  };
  struct Row {                      // a contact in the running step; vectors along its axes
    Eigen::Matrix3d axes;           // columns: normal and two tangents, world
    Eigen::Vector3d target;         // the point's displacement just allowed, or without slip [m]
    Eigen::Vector3d surface_speed;  // [m/s]
    Eigen::Vector3d force;          // constant during the step [N]
    Eigen::Vector3d known;          // the same of the step before [N]
    Eigen::Vector3d impulse;        // at the step's end [N s]
    double own, own_tangent;        // the point's displacement per force [m/N]
    double mass_own, mass_tangent;  // change of its velocity per impulse [1/kg]
  };
  /// From contact `first` on; lets the forces of the step before act.
  void add_rows(std::size_t first, const Step& step, ReducedSystem& system);
  /// Takes in points that the others' forces pushed into obstacles; whether there are any.
  bool add_late(const Step& step, ReducedSystem& system);
  /// One contact; both return how far, or how fast, that moved its point.
  double push(std::size_t contact);
  double slow(std::size_t contact, double h, Eigen::VectorXd& p);
  /// Until nothing moves more than `small`.
  void solve_positions(double small);
  void solve_velocities(double h, double small, Eigen::VectorXd& p);
  void keep(std::vector<Contact>& contacts, double h);
  Eigen::Vector3d known_force(const Contact& contact) const;

  const ReducedVertices& vertices_;
  const EmbeddedPoints& points_;
  std::vector<Touch> touches_, touches_start_;  // by obstacle and point
  Eigen::VectorXd guess_, guess_start_;
  std::vector<Row> rows_;
  std::vector<Contact> late_;
  std::vector<double> bounds_;    // Coulomb's coefficient of each row
  Eigen::MatrixXd gradients_;     // Uᵀ times the axes: three columns a row, room for more
  Eigen::MatrixXd moves_;         // C times them
  double softness_ = 0.0;         // [m/N]
  double mass_softness_ = 0.0;    // [1/kg]
  Eigen::VectorXd displacement_;  // of q since the step's beginning
  bool is_shifted_ = false;       // by other forces in this step
  Eigen::VectorXd moved_;         // what a force did to q or p
};

}  // namespace pliant
