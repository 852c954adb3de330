#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

using Positions = Eigen::Matrix3Xd;  ///< 3 x n [m]
using Forces = Eigen::Matrix3Xd;     ///< 3 x n [N]

/// What inertia goes on from in a running step whose integration looks at earlier steps
/// (time_integration.h).
struct InertialStart {
  bool is_used = false;  ///< false: the step's beginning, x_start and v_start
  double share = 0.0;    ///< of the last step's motion that goes on, above 0
  double step = 0.0;     ///< the effective one: v = (x - this x) / step [s]
  double whole = 0.0;    ///< the step's length [s]
  Positions x;           ///< [m]
  Eigen::Matrix3Xd v;    ///< [m/s]
};

/// What integrations of second order remember of the last step.
struct MotionHistory {
  double dt = 0.0;          ///< of that step [s]; 0: nothing is known of it
  double reserve = 0.0;     ///< energy that steps lost and may gain again [J]
  bool touched = false;     ///< whether it was taken as one in which constraints may act
  Eigen::Matrix3Xd moved;   ///< how far each particle came [m]
  Eigen::Matrix3Xd gained;  ///< velocity that forces gave it [m/s]
};

/// Point masses, and where they were when the running step began.
struct Particles {
  Positions x;                   ///< [m]
  Eigen::Matrix3Xd v;            ///< [m/s]
  Positions x_start;             ///< x at the beginning of the last step [m]
  Eigen::Matrix3Xd v_start;      ///< v at the beginning of the last step [m/s]
  Eigen::Matrix3Xd v_before;     ///< during a step: v at the beginning of the one before it [m/s]
  InertialStart inertia;         ///< of the running step
  MotionHistory history;         ///< of the last step; during a step: none yet
  MotionHistory history_before;  ///< during a step: of the one before it
  Eigen::VectorXd mass;          ///< [kg]
  Eigen::VectorXd inverse_mass;  ///< [1/kg], 0 for a fixed particle

  Particles() = default;
  /// At rest at `positions`. Throws InputError when a mass is not positive and finite.
  Particles(const Positions& positions, const Eigen::VectorXd& masses);

  int size() const { return static_cast<int>(x.cols()); }
  /// Where inertia goes on from in the running step, with what velocity: of implicit Euler its
  /// beginning.
  const Positions& x_inertial() const { return inertia.is_used ? inertia.x : x_start; }
  const Eigen::Matrix3Xd& v_inertial() const { return inertia.is_used ? inertia.v : v_start; }
  bool is_fixed(int i) const { return inverse_mass[i] == 0.0; }
  /// A fixed particle stays where it is put: no solver moves it.
  void fix(int i);
  /// Those of another body follow these.
  void append(const Particles& others);
  void release(int i) { inverse_mass[i] = 1.0 / mass[i]; }

  double kinetic_energy() const;             ///< [J]
  Eigen::Vector3d momentum() const;          ///< [kg m/s]
  Eigen::Vector3d angular_momentum() const;  ///< about the origin [kg m^2/s]
  Eigen::Vector3d center_of_mass() const;    ///< [m]
};

}  // namespace pliant
