#pragma once

#include <Eigen/Core>

namespace pliant {

/// What the water in a body does where its points touch obstacles.
struct WetContact {
  Eigen::VectorXd adhesion;         ///< with which it holds each point at the most [N]
  Eigen::VectorXd friction_factor;  ///< factor on the friction of each point
  double range = 0.0;               ///< gap from which on it holds nothing [m]
};

/// A service of effects whose contacts water changes.
class TakesWetness {
 public:
  virtual ~TakesWetness() = default;
  /// Water at the points from now on; `wet` outlives this.
  virtual void set_wetness(const WetContact* wet) = 0;
};

}  // namespace pliant
