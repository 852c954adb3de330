#pragma once

#include "pliant/core/parameters.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// `damping` of a material [s].
ParameterSpec material_damping_parameter();

/// Damps the system's element sets from number `first` on with a viscosity `time` [s] times their
/// stiffness (Kelvin-Voigt); nothing where it is 0.
void add_damping(ProjectiveSystem& system, std::size_t first, double time);

}  // namespace pliant
