#pragma once

#include <vector>

#include "cuda/core/vector.h"

namespace pliant {

class ClusterShapes;

/// Where all particles rest if clusters' shapes are parts of one, by their places [quanta] beside
/// their masses, and the quantum [m]. False, and nothing changed, where shapes do not fit together
/// or a particle counts differently in two of them.
bool find_common_rest(const ClusterShapes& shapes, const std::vector<int>& place, int places,
                      std::vector<Fixed>& rest, double& quantum);

}  // namespace pliant
