#pragma once

#include "pliant/core/system/system.h"

namespace pliant {

/// How small residuals are where errors of solids are small, over these errors. A residual measures
/// forces by the stiffness D of what holds a body together, |D^-1/2 f|, and a force that moves the
/// whole of a free body is resisted by its inertia M/h² alone: an error of its place is as many
/// times the residual as (ΣD / ΣM/h²)^1/2 says, 2,000 of a ball of 1e8 Pa and 4 cm in steps of
/// 10 ms. Nothing else tells before the body hits something. Of cloth, which bends, errors are of
/// other motions. `diagonal` D and `inertia` M/h² are of each particle [N/m].
double share_of_free_solids(const ProjectiveSystem& system, const Eigen::VectorXd& diagonal,
                            const Eigen::VectorXd& inertia);

}  // namespace pliant
