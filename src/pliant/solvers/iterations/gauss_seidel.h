#pragma once

#include "pliant/solvers/iterations/implicit_euler.h"
#include "pliant/solvers/iterations/relaxation.h"
#include "pliant/solvers/linear/vertex_coloring.h"

namespace pliant {

/// Projective dynamics whose global step is one Gauss-Seidel sweep over the particles, colour by
/// colour (Fratarcangeli et al. 2016): A d = r, from d = 0, then x += d.
/// As `hybrid` the colours are bounded in number, so that each is large enough for many threads,
/// and the particles left over take a Jacobi update at the end of the sweep (Fratarcangeli and
/// Pellacini 2015).
class GaussSeidelSolver final : public ImplicitEulerSolver {
 public:
  /// `max_colors` 0 makes it `gauss_seidel`.
  GaussSeidelSolver(const StopRule& rule, int max_colors)
      : ImplicitEulerSolver(rule), max_colors_(max_colors) {}
  std::string_view name() const override { return max_colors_ > 0 ? "hybrid" : "gauss_seidel"; }

 protected:
  bool needs_matrix() const override { return true; }
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  const Eigen::VectorXd& mobility() const override {
    return sweeps_ ? mobility_ : relaxation_.mobility;
  }

 private:
  void sweep();

  int max_colors_;
  bool sweeps_ = true;  // false where a constraint is collective
  Relaxation relaxation_;
  VertexColoring coloring_;
  Eigen::VectorXd mobility_;  // 1 / A_ii, for the overflow bounded by its own row sums [m/N]
  Forces balance_;            // r with the constraints' forces [N]
  Positions correction_;      // d [m]
  Positions overflow_;        // d of the overflow before it is taken over [m]
};

SolverRegistry::Entry gauss_seidel_entry();
SolverRegistry::Entry hybrid_entry();

}  // namespace pliant
