#pragma once

#include <algorithm>
#include <cstdint>

#include "pliant/core/system/point_constraint.h"
#include "pliant/core/system/system.h"

namespace pliant {

struct StepReport;

/// Keeps steps of implicit Euler from gaining energy, as iterations do that stop early or that
/// contacts throw from side to side. What a converged step ends with, elastic and kinetic, is no
/// more than
///   E(x₀) + ½ |M^½ (y − x₀)|²/h² + W,
/// the energy at the step's beginning with the work of external forces in it, y the prediction, and
/// the work W of friction of surfaces that move under what they touch. Air counts by the work of
/// the pressure at the step's end, which is less than its own energy loses. Energy that other steps
/// lost within the last second may be gained again, and a tenth of the energy besides: so the sum
/// of all steps gains no more than that, and noise in each of them is no matter. What viscous
/// materials dissipate, and what air could have given, is not among what may be gained again.
///
/// A step that begins with bodies nearer to each other than they may be has to part them, which
/// gives it energy. With z, the step's beginning moved as little as parts them, it ends with no
/// more than (A^½ + B^½)², A = E(z) + ½ |M^½ (y − z)|²/h² + W, B = ½ |M^½ (z − x₀)|²/h²: A bounds
/// E + ½ |M^½ (x − z)|²/h², and the triangle inequality does the rest. What that is more counts as
/// gained. Of steps that begin where an obstacle or a body that another solver moves comes to be it
/// knows only what is far too much: ten times the energy of moving out of its way. Of steps in
/// which air has less room than it needs as it comes, or of cloth with a strain limit, it knows
/// nothing.
class StepEnergy {
 public:
  void prepare(double dt);
  /// After the iterations of a step, with the multipliers that they found.
  void begin(ProjectiveSystem& system);
  /// Whether the step gains, if it ends at the present positions.
  bool gains(const ProjectiveSystem& system);
  /// Whether it ends with more than forces explain, whatever was lost before.
  bool gains_any(const ProjectiveSystem& system);
  /// Goes as much less far as it takes not to gain.
  void hold_back(ProjectiveSystem& system);
  /// The step ends at the present positions.
  void end(const ProjectiveSystem& system);
  /// After end(): whether the velocities are allowed too, of what the solver moves.
  bool allows(const Particles& particles) const;
  /// After end(): whether it is known what the step was allowed, and what it ended with beyond the
  /// energy at its beginning and the work of forces [J]; below 0 it lost some.
  bool is_known() const { return is_known_; }
  double gained() const { return gained_; }

  /// Says that a step does not end where its iterations came.
  static void warn(StepReport& report);

  /// Another run begins.
  void forget() { reserve_ = 0.0; }
  void save(StateArchive& numbers) const { numbers.write(reserve_); }
  void load(StateArchive& numbers);

 private:
  // Share of its energy that a scene may gain.
  static constexpr double kGained = 0.1;
  // What arrives works with a force that nobody knows before.
  static constexpr double kArrivals = 10.0;

  /// What was gained before is no reason to stop what moves.
  double most() const { return std::max(allowed_, (1.0 + kGained) * balanced_ + reserve_); }
  /// Kinetic, of a displacement in one step [J].
  double energy_of_displacement(const Particles& particles, const Positions& from,
                                const Positions& to) const;
  /// Kinetic, of the displacement from the step's beginning [J].
  double kinetic(const Particles& particles) const;
  /// Finds kept_, given_ and dissipated_, once for the same positions.
  void find_energies(const ProjectiveSystem& system);
  /// That the step ends with at the present positions [J].
  double total(const ProjectiveSystem& system);
  /// Collects what constrains the step's beginning; false where not all of it is known.
  bool find_constraints(ProjectiveSystem& system);
  /// Whether the step's beginning fulfils all constraints.
  bool starts_free() const;
  /// Whether no obstacle, and no body that another solver moves, comes to be there.
  bool nothing_arrives(const ProjectiveSystem& system) const;
  /// Moves the step's beginning in starts_ to where it fulfils the constraints.
  void part(const ProjectiveSystem& system);
  /// What a step ends with at most that begins at starts_, but for the work of friction [J].
  double from_start(ProjectiveSystem& system);
  /// Work of friction of surfaces that moved under points [J].
  double dragged() const;

  double dt_ = 0.0;     // [s]
  double decay_ = 0.0;  // of the reserve, in a step
  PointConstraints constraints_;
  Positions starts_;       // of the step, of what it moves, parted where it is not free [m]
  Positions began_;        // before that [m]
  Positions end_;          // of the iterations [m]
  double balanced_ = 0.0;  // energy at the beginning and work of forces [J]
  double allowed_ = 0.0;   // that, or what parting gives too [J]
  bool is_known_ = false;  // and not only a bound far above
  double reserve_ = 0.0;   // lost by earlier steps; below 0: gained [J]
  // At the positions of that fingerprint: energy of elements, what air gave on the path there, and
  // what the material dissipates in a step that ends there [J].
  double kept_ = 0.0, given_ = 0.0, dissipated_ = 0.0;
  std::uint64_t places_ = 0;
  double most_ = 0.0;    // that the step might end with [J]
  double gained_ = 0.0;  // by the step that ended [J]
};

}  // namespace pliant
