#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/system/point_constraint.h"
#include "pliant/math/offers.h"

namespace pliant {

struct StepReport;

/// Linear conditions on a displacement d, J d = c + C mu, with forces -J^T mu that hold them: what
/// constraints hold in their present state. Reused, so that it allocates nothing once it is warm.
class ConstraintRows {
 public:
  struct Entry {
    int particle;
    Eigen::Vector3d gradient;
  };

  void clear();
  /// Begins a row with its `target` c [m] and `compliance` C >= 0 [m/N], for a gradient without
  /// unit.
  void begin_row(double target, double compliance);
  void add(int particle, const Eigen::Vector3d& gradient);

  /// Of those that were added, from number `first` on, the particles have numbers higher by `by`.
  void renumber(std::size_t first, int by);
  std::size_t entries() const { return entries_.size(); }

  int size() const { return static_cast<int>(compliances_.size()); }
  double target(int row) const { return targets_[static_cast<std::size_t>(row)]; }
  /// Whether all targets are 0: the present state fulfils the conditions.
  bool are_met() const { return met_; }
  double compliance(int row) const { return compliances_[static_cast<std::size_t>(row)]; }
  const Entry* begin(int row) const {
    return entries_.data() + begins_[static_cast<std::size_t>(row)];
  }
  const Entry* end(int row) const {
    return entries_.data() + begins_[static_cast<std::size_t>(row) + 1];
  }

 private:
  bool met_ = true;
  std::vector<double> targets_;
  std::vector<double> compliances_;
  std::vector<std::size_t> begins_ = {0};
  std::vector<Entry> entries_;
};

/// A nonlinear condition on positions that no element set expresses: contact with obstacles, air
/// in a sealed volume. Every solver treats it the same way: after each of its updates the
/// constraint moves particles by mobility * force and keeps the force as its multiplier.
class Constraint : public Offers {
 public:
  virtual std::string_view name() const = 0;

  /// `particles.x_start` is where the step began, `particles.x` the predicted end.
  virtual void begin_step(const Particles& particles, double dt) = 0;
  /// Solvers whose update starts anew from all forces (Jacobi) call this before each relax(),
  /// those that accumulate displacements (XPBD) once a step.
  virtual void reset_multipliers() = 0;
  /// Moves x[i] by mobility[i] * force [m/N], implicitly in x. A fixed particle has mobility 0.
  virtual void relax(const Eigen::VectorXd& mobility, Positions& x) = 0;
  /// f += the forces that the multipliers stand for [N].
  virtual void add_forces(Forces& f) const = 0;
  /// The directions in which it holds particles at present, for solvers that move all of them at
  /// once and must not undo what the constraint did.
  virtual void add_rows(const Positions& x, ConstraintRows& rows) = 0;
  /// Whether a solver can find its multipliers together with the displacement, by the functions
  /// below; add_rows() and relax() are then not called.
  virtual bool takes_multipliers() const { return false; }
  /// Whether add_point_constraints() tells all that it holds, whoever finds its multipliers.
  virtual bool tells_point_constraints() const { return takes_multipliers(); }
  /// Begins a step with the multipliers that the last one ended with.
  virtual void warm_start() {}
  /// Appends its constraints on points at `x` with their present multipliers, or, of one that only
  /// adds to what another appended, adds to those.
  virtual void add_point_constraints(const Positions& /*x*/, PointConstraints& /*constraints*/) {}
  /// Whether only solvers that have its constraints in their matrix find them, as those that tie
  /// many particles.
  virtual bool needs_matrix() const { return false; }
  /// Takes the multipliers of the constraints that it appended last.
  virtual void take_multipliers(const PointConstraints& /*constraints*/) {}
  /// Whether one of its conditions ties many particles, as a volume does: then a particle's own
  /// share of it says little of the whole.
  virtual bool is_collective() const { return false; }
  /// Work that its forces at `x` do on the path there from where the running step began [J]; what
  /// only keeps points apart does none.
  virtual double work(const Positions& /*x*/) const { return 0.0; }
  /// Whether that is all that its forces can give in this step.
  virtual bool tells_energy() const { return true; }
  /// Whether begin_step() found nothing that could carry force in this step.
  virtual bool is_idle() const { return false; }
  /// How many of its conditions carry force at present.
  virtual int active() const { return 0; }
  /// After the solver's iterations: looks again for what they moved into each other at `x`, and
  /// keeps what begin_step() did not see coming. Whether any of that is so near that iterations
  /// have to answer it. They are `done` where a tolerance ended them and not their number: then
  /// less may be left to the final projection.
  virtual bool finds_more(const Positions& /*x*/, bool /*done*/) { return false; }
  /// Comes after the solver's iterations, for conditions that must hold exactly.
  virtual void final_projection(const Eigen::VectorXd& /*mobility*/, Positions& /*x*/) {}
  /// Whether the final projections of others must not undo its own.
  virtual bool needs_alternating_projection() const { return false; }
  /// Where one of them does, all take turns after their final projections: each call moves what the
  /// others left. Returns by how much the constraint was missed, as a multiple of what may be left.
  virtual double alternating_projection(const Eigen::VectorXd& /*mobility*/, Positions& /*x*/) {
    return 0.0;
  }
  /// After everything else: whether nothing passes through anything on the straight path to x from
  /// where the step began or where the last call let it come. Else x goes back to where nothing
  /// does, and all projections are repeated before it is asked for the rest of the path.
  virtual bool limit_displacement(Positions& /*x*/) { return true; }
  virtual void report(StepReport& /*report*/) const {}
};

}  // namespace pliant
