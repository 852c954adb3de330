#pragma once

#include <Eigen/Core>
#include <string>

#include "pliant/models/reduced/quartic_potential.h"

namespace pliant {

/// The potential of a `.cub` file, and the coordinates that it is in.
struct CubPotential {
  /// In coordinates q in which K(0) is diagonal.
  QuarticPotential potential;
  /// r x r, orthogonal: the file's own coordinates are rotation * q.
  Eigen::MatrixXd rotation;
};

/// Reads a cubic polynomial of reduced internal forces as the Vega FEM library writes it (class
/// StVKReducedInternalForces, Save(); little-endian): i32 r, i32 r, i32 r (r + 1)/2,
/// i32 r (r + 1) (r + 2)/6; f64 linear, quadratic and cubic coefficients, of one component of the
/// force after the other, each in the order i <= j <= k of the loops "for i, for j, for k".
/// The file's masses must be 1 (a mass-orthonormal basis): it does not hold them. Its polynomial
/// must be the gradient of a potential with a K(0) that is not negative, to 1e-6 of its largest
/// coefficient of that degree; programs that sum in another order differ by less. Throws
/// InputError, naming the file and what is wrong: missing, shorter or longer than its sizes say,
/// sizes that do not belong to r, r outside [1, 60], numbers that are not finite, no gradient.
CubPotential read_cub(const std::string& path);

}  // namespace pliant
