#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/core/group.h"
#include "pliant/solvers/constrained/contact_impulses.h"
#include "pliant/solvers/iterations/factored_solver.h"
#include "pliant/solvers/iterations/xpbd.h"

namespace pliant {

/// Moves bodies in contact whose solvers differ: some are moved by sweeps of `xpbd`, the others by
/// corrections of one solver that finds the forces of contacts together with them (`direct`,
/// `lbfgs`, `newton`). After some sweeps over the first, a correction moves the others and finds
/// the contacts of both, to which the particles of the first answer as free masses, by h²/m. That
/// is what sweeps of xpbd take for the answer to a contact too, and never less than the true one,
/// so that the forces grow to it: where iterations end, all is as one solver would have left it.
/// Where all corrected bodies are of coordinates, rigid bodies of `xpbd` are moved by corrections,
/// too, which answer at once by the inertia of the whole body what sweeps find in hundreds.
///
/// Bodies of coordinates make a step of their own first. In corrections they answer by the response
/// of their integrator (responding_system.h), and what else holds them, as contact with obstacles,
/// follows each correction. At the end impulses keep them from bouncing (contact_impulses.h).
class LockstepSolver final : public ProjectiveSolver {
 public:
  /// Of a group whose bodies have their solvers. Throws InputError where these cannot go together.
  explicit LockstepSolver(const Group& group);
  std::string_view name() const override { return "lockstep"; }
  bool takes_time_integration() const override { return false; }

 protected:
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void move_others(ProjectiveSystem& system, double dt) override;
  void end_others(ProjectiveSystem& system, double dt) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;
  void save_learned(StateArchive& numbers) const override;
  void load_learned(StateArchive& numbers) override;
  // Corrections hold what momentum their forces give, and so do sweeps.
  bool loses_momentum(const ProjectiveSystem&) const override { return false; }
  bool corrects_velocities(const ProjectiveSystem&) const override { return false; }
  // A sweep finds contact with obstacles too, and a correction the forces of contacts by some
  // hundred solutions with its factor. Measured on a strip of cloth over a soft ball and a box.
  double iteration_price() const override { return 2.5 * parts_.sweeps + 120.0; }

 private:
  struct Member {
    Body* body;
    System* system;
    XpbdSolver* sweeps;  // null: something else moves it
    Solver* own_steps;   // null: something else moves it
    int count = 1;       // of sweeps before each correction
  };
  struct Parts {
    ImplicitEulerSolver* corrections = nullptr;
    std::shared_ptr<FactoredSolver> own_corrections;  // where no body brings any
    std::vector<Member> members;
    int sweeps = 1;  // before each correction, at the most
    std::vector<std::string> warnings;
    StopRule rule;
  };
  explicit LockstepSolver(Parts parts, const Group& group);
  static Parts parts_of(const Group& group);
  /// Throws InputError unless the body's solver goes together with those of the bodies before.
  static void take_corrections(const Body& body, Solver& solver, const Body*& corrected,
                               Parts& parts);
  /// What a body's solver was told that sets nothing here.
  static void warn_of_ignored(const Body& body, const Member& member, Parts& parts);
  /// Shares sweeps out between corrections.
  static void share_sweeps(Parts& parts);

  /// Whether corrections move what `xpbd` would sweep.
  bool answers_in_corrections(System& system) const;
  /// Whether sweeps move anything.
  bool is_swept() const { return !swept_elements_.empty() || !swept_constraints_.empty(); }
  void begin(ProjectiveSystem& system, StepReport& report);
  void sweep(ProjectiveSystem& system, double dt, StepReport& report);
  void find_contact_forces(const ProjectiveSystem& system);
  bool correct(ProjectiveSystem& system, StepReport& report);
  /// Whether the last correction, from positions `before` [m], changed next to nothing where
  /// nothing else moves what it moves.
  bool agrees(const ProjectiveSystem& system, const Positions& before) const;
  /// Takes responder `k` where the forces of contacts that were found move it.
  void respond(std::size_t k, Positions& x);
  /// The share of its displacement that the final projection let responder `k` go.
  double share_of_displacement(std::size_t k, const Particles& particles) const;

  Parts parts_;
  const Group& group_;
  std::unique_ptr<JointSystem> corrected_;  // the members that corrections move, the others bare
  /// Of a member that is swept so many times before each correction.
  template <class What>
  struct Swept {
    What* what;
    int count;
  };
  std::vector<Swept<ElementSet>> swept_elements_;
  std::vector<Swept<Constraint>> swept_constraints_;
  StepObjective objective_;  // of all
  Eigen::VectorXd answers_;  // h²/m, also of the final projection, which so keeps momentum [m/N]
  Eigen::VectorXd corrected_answers_;  // the same in corrected_ [m/N]
  Forces contact_;                     // between bodies [N]
  Forces forces_;
  Positions predicted_;           // without the forces of contact [m]
  Positions before_;              // the last correction [m]
  std::vector<Positions> moved_;  // responders' particles, where forces took them last [m]
  Forces on_responder_;
  ContactImpulses impulses_;
};

std::unique_ptr<Solver> make_lockstep(const Group& group);

}  // namespace pliant
