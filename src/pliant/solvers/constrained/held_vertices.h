#pragma once

#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// The last turn of what attachments hold, in steps whose sweeps project constraints one after the
/// other: contacts and limits had the last one, and what holds is told of forces that fit the
/// places.
class HeldVertices {
 public:
  /// Relaxes them once. Returns the mobility for all that follows, by which their springs give way
  /// implicitly, 1 / (1/`mobility` + k) [m/N]: `mobility` itself where nothing is held.
  const Eigen::VectorXd& settle(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                double dt);

 private:
  std::vector<HeldVertex> held_;
  Eigen::VectorXd held_mobility_;
};

}  // namespace pliant
