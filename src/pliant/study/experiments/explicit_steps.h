#pragma once

#include <vector>

namespace pliant {

struct SceneSpec;
struct SolverSetting;

/// For an explicit solver: each of `wished` [s], largest first, halved until the solver no longer
/// warns that the step is unstable; then half of the smallest. Without doubles, largest first.
/// A step that 20 halvings do not cure stays as it was.
std::vector<double> explicit_time_steps(const SceneSpec& scene, const SolverSetting& solver,
                                        const std::vector<double>& wished);

}  // namespace pliant
