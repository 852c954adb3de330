#pragma once

#include <vector>

#include "pliant/elements/cloth/bending_stencils.h"

namespace pliant {

/// The constant stiffness of bending: the force on i is Σ_j value (x_j - x_i) over what row i has
/// [N/m].
struct BendingRows {
  std::vector<int> begins = {0};
  std::vector<int> columns;
  std::vector<double> values;
};

/// 1/2 Σ |κ|² of pieces [begin, end), one after the other [J]. `positions`: 3 a particle [m]. By
/// vector registers, with the same bits for any width of them, as what follows.
double bending_energy(const BendingStencils& stencils, const double* positions, int begin, int end);

/// Adds to `forces`, 3 a particle [N], those on particles [begin, end).
void add_bending_forces(const BendingRows& rows, const double* positions, int begin, int end,
                        double* forces);

}  // namespace pliant
