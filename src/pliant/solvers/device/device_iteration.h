#pragma once

namespace pliant {

/// How an iteration of a solver on a GPU corrects positions for the unbalanced forces.
struct DeviceIteration {
  enum Kind {
    kJacobi,
    kLineSearch,   ///< line_search_jacobi
    kSweep,        ///< gauss_seidel and hybrid
    kQuasiNewton,  ///< lbfgs
  };
  Kind kind = kJacobi;
  double spread = 1.0;  ///< weighted: largest weight, and one over the smallest
  int colors = 0;       ///< sweeps: at most; 0: as many as it takes
  // Quasi-Newton.
  static constexpr int kMostHistory = 8, kMostSweeps = 64;
  int history = 0;            ///< earlier iterations that shape the next one
  int sweeps = 0;             ///< of a Chebyshev iteration on A, in place of its factor
  bool is_multigrid = false;  ///< they smooth a V-cycle (Multigrid), which takes that place
  int solid_sweeps = 0;       ///< so many alone in a solid, whose waves are short; 0: never
};

}  // namespace pliant
