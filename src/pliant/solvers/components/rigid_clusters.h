#pragma once

#include <functional>

#include "pliant/core/system/system.h"

namespace pliant {

/// Calls `see` for each cluster of particles in the system.
void for_each_cluster(const ProjectiveSystem& system,
                      const std::function<void(const SharedEntries&)>& see);

/// Whether a cluster's particles are a rigid body, as those of the model `rigid` are: few, and so
/// stiff that they bend by a micrometre under their weight.
bool is_rigid(const SharedEntries& cluster);

/// Whether rigid clusters, of which there are some, are all that acts between the system's
/// particles and on them.
bool is_made_of_rigid_bodies(const ProjectiveSystem& system);

/// Makes `mobility`, how far a force moves a particle while its neighbours stay, what contact moves
/// it by [m/N]: the neighbours of a rigid body's particle never stay, so that its `inertia` m/h²
/// alone counts [N/m].
void let_rigid_bodies_move(const ProjectiveSystem& system, const Eigen::VectorXd& inertia,
                           Eigen::VectorXd& mobility);

}  // namespace pliant
