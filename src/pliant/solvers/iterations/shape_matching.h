#pragma once

#include "pliant/elements/clusters/cluster_sweep.h"
#include "pliant/solvers/constrained/held_vertices.h"
#include "pliant/solvers/iterations/projective_solver.h"
#include "pliant/solvers/iterations/stop_check.h"

namespace pliant {

/// Shape matching as the thesis on particles from rigid to liquid solves it: from the prediction
/// on, clusters move their particles to their goals (ClusterSweep) until few strains are left, and
/// of that displacement y → x a step takes the share `alpha` (eq. 2.23), 1 − beta of it for a
/// particle that melts (eq. 2.40). There is no modulus in it: how stiff a body looks is a matter of
/// iterations, of the step and of `alpha`. Momentum, contact and energy are treated as in all
/// projective solvers.
class ShapeMatchingSolver final : public ProjectiveSolver {
 public:
  ShapeMatchingSolver(const StopRule& rule, ClusterOrder order, double alpha)
      : ProjectiveSolver(rule), sweep_(order), alpha_(alpha) {}
  std::string_view name() const override { return "shape_matching"; }
  /// They solve for no forces, so that there is no error of a step to tell, and no other time
  /// integration to make of it.
  bool is_implicit() const override { return false; }

 protected:
  bool loses_momentum(const ProjectiveSystem& /*system*/) const override { return true; }
  bool guards_energy() const override { return true; }
  bool corrects_velocities(const ProjectiveSystem& /*system*/) const override { return true; }
  bool leaves_momentum() const override { return true; }
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  void look_at_elements(const ProjectiveSystem& system);
  void iterate(ProjectiveSystem& system, double dt, StepReport& report);
  double strain(const ProjectiveSystem& system) const;
  void take_share(Positions& x) const;

  ClusterSweep sweep_;
  double alpha_;
  const ClusterSet* clusters_ = nullptr;  // of the running step; null: nothing is solid
  long version_ = 0;                      // that sweep_ is prepared for; 0: none
  std::vector<ElementSet*> others_;       // of the running step: what else ties its particles
  Eigen::VectorXd mobility_;              // h² / m [m/N]
  Positions predicted_;                   // y [m]
  HeldVertices held_;
};

SolverRegistry::Entry shape_matching_entry();

}  // namespace pliant
