#pragma once

#include <memory>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/core/system/element_set.h"
#include "pliant/elements/solids/elastic_material.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Of a material, which of its strains count: `strain: tetrahedra` or `averaged`.
ParameterSpec strain_parameter();
constexpr const char* kAveragedStrain = "averaged";

/// The material of TetrahedronSet without its locking, and with no more unknowns: shear
/// E = μ V |G − R|² of the mean gradient G of the tetrahedra around each edge, and pressure
/// E = λ/2 V (Σσ − 3)² of that around each vertex, V the share of their volumes (Onishi, Iida and
/// Amaya 2017, selective edge- and node-based smoothed finite elements of 4-node tetrahedra).
/// Constant strains are exact on any mesh. The set of pressures leaves out pinned vertices where it
/// is told of them (leaves_out_pinned.h). Throws InputError as TetrahedronSet.
std::vector<std::unique_ptr<ElementSet>> averaged_tetrahedra(const TetrahedralMesh& rest,
                                                             const LameParameters& lame,
                                                             int first_particle = 0);

}  // namespace pliant
