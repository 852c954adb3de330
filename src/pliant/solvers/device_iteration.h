#pragma once

namespace pliant {

/// How an iteration of a solver on a GPU corrects positions for the unbalanced forces.
struct DeviceIteration {
  enum Kind {
    kJacobi,
    kWeighted,  ///< weighted_jacobi
    kSweep,     ///< gauss_seidel and hybrid
  };
  Kind kind = kJacobi;
  double spread = 1.0;  ///< weighted: largest weight, and one over the smallest
  int colors = 0;       ///< sweeps: at most; 0: as many as it takes
};

}  // namespace pliant
