#pragma once

#include <string>
#include <vector>

namespace pliant {

struct SceneSpec;
struct SolverSetting;

/// Two different solvers for references: `wished` first, then the most exact ones of `suitable`.
/// Throws InputError for one that does not iterate, for two that are equal, for more than two, and
/// when fewer than two are left.
std::vector<std::string> choose_references(const std::vector<std::string>& suitable,
                                           const std::vector<std::string>& wished);

/// The solver that takes a scene from one sample to the next, close to the references' run: one
/// that is much faster than the first reference where `suitable` has it.
SolverSetting runner_setting(const SceneSpec& scene, const std::vector<std::string>& suitable,
                             const std::string& first_reference);

/// A reference solver that iterates until `tolerance` of its residual, or as far as makes sense.
SolverSetting reference_setting(const SceneSpec& scene, const std::string& name, double tolerance);

}  // namespace pliant
