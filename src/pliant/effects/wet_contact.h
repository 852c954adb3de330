#pragma once

#include <Eigen/Core>

namespace pliant {

/// What the water in a body does where its points touch obstacles.
struct WetContact {
  Eigen::VectorXd pull;  ///< with which it holds each point at the most [N]
  Eigen::VectorXd grip;  ///< factor on the friction of each point
  double range = 0.0;    ///< gap from which on it holds nothing [m]
};

}  // namespace pliant
