#pragma once

#include <memory>
#include <vector>

#include "pliant/elements/solids/elastic_material.h"
#include "pliant/elements/solids/simplex_set.h"
#include "pliant/geometry/meshing/lattice.h"

namespace pliant {

/// The element sets that make a body of this material.
std::vector<std::unique_ptr<ElementSet>> make_solid(const TetrahedralMesh& rest,
                                                    const ElasticMaterial& material);

std::vector<const ElementSet*> pointers(const std::vector<std::unique_ptr<ElementSet>>& sets);

/// Whether a vertex of make_block() lies on a face of the block: axis 0 to 2, side -1 or 1.
bool on_face(const TetrahedralMesh& block, int vertex, int axis, int side);

bool on_boundary(const TetrahedralMesh& block, int vertex);

/// A block whose inner vertices are off their places by up to `share` of a cell.
TetrahedralMesh jittered_block(const BlockOptions& options, double share);

}  // namespace pliant
