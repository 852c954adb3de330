#pragma once

#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Some of the points `among`, in their order, no two nearer than `separation` and every other one
/// within it of one of them: a Poisson-disk subset that covers all.
std::vector<int> spaced_subset(const Positions& x, const std::vector<int>& among,
                               double separation);

/// The least separation of spaced_subset() that leaves no more than `fraction` (0 to 1] of the
/// points, but at most `largest` [m].
double separation_for(const Positions& x, const std::vector<int>& among, double fraction,
                      double largest);

/// For each centre those of `among` within `radius` of it, ascending.
std::vector<std::vector<int>> groups_about(const Positions& x, const std::vector<int>& centers,
                                           const std::vector<int>& among, double radius);

}  // namespace pliant
