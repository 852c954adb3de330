#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

using Positions = Eigen::Matrix3Xd;  ///< 3 x n [m]
using Forces = Eigen::Matrix3Xd;     ///< 3 x n [N]

/// Point masses, and where they were when the running step began.
struct Particles {
  Positions x;                   ///< [m]
  Eigen::Matrix3Xd v;            ///< [m/s]
  Positions x_start;             ///< x at the beginning of the last step [m]
  Eigen::Matrix3Xd v_start;      ///< v at the beginning of the last step [m/s]
  Eigen::Matrix3Xd v_before;     ///< during a step: v at the beginning of the one before it [m/s]
  Eigen::VectorXd mass;          ///< [kg]
  Eigen::VectorXd inverse_mass;  ///< [1/kg], 0 for a fixed particle

  Particles() = default;
  /// At rest at `positions`. Throws InputError when a mass is not positive and finite.
  Particles(const Positions& positions, const Eigen::VectorXd& masses);

  int size() const { return static_cast<int>(x.cols()); }
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
