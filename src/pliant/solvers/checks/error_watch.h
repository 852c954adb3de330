#pragma once

#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/core/step/step_report.h"
#include "pliant/solvers/checks/step_error.h"

namespace pliant {

/// Estimates the errors of some of a solver's steps, so that this costs little beside the
/// iterations: in a row at the start and when something touches (what such steps miss stays in the
/// velocities), and else as often as a share of the iterations' work pays for. Work is counted, not
/// timed, so that every run estimates the same steps.
class ErrorWatch {
 public:
  /// Above it steps are said to be inaccurate.
  static constexpr double kInaccurate = 0.05;

  /// The system's structure or the time step changed.
  void prepare(const ProjectiveSystem& system) { estimate_.prepare(system); }
  /// Whether errors of this system are estimated at all.
  bool suits() const { return estimate_.suits(); }
  /// After a step, before anything else changes velocities or external forces: tells `report` how
  /// far the bodies are off by what this and former steps missed, or were off shortly before,
  /// with a warning where that is much; `cure` says what to do about it. Returns whether this very
  /// step was estimated.
  bool observe(ProjectiveSystem& system, double dt, std::string_view cure, StepReport& report);
  /// What one of the solver's iterations costs, in those of a solver on the CPU, where estimates
  /// are made.
  void set_price(double price) { price_ = price; }
  /// Somebody acts on the estimates: they come often, whatever they cost.
  void watch_closely() { is_watched_ = true; }
  /// Where somebody acts on it: the error if all steps had missed as much as the one that was
  /// estimated last.
  double lasting() const { return lasting_; }
  /// Another run begins.
  void forget();
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  /// An error, and what it is a share of.
  struct Told {
    double error = 0.0;
    double distance = 0.0;  // that the piece came then [m]
    int piece = 0;
  };
  /// `error` of the worst piece of the last estimate.
  Told told(double error) const;
  /// The same length as a share of how far a free piece came by now, where that is further: an
  /// error of the first millimetre would stand until long after it. Of one that is held the share
  /// stays: a wrong equilibrium is off by more the further it is from the start.
  void update(Told& told) const;
  bool is_first(const StepReport& report) const {
    return error_step_ == 0 || report.step < error_step_;
  }
  bool is_due(const System& system, const StepReport& report);
  /// Whether a constraint carries more than twice as much as in the step before.
  bool begins_to_touch(const System& system);
  bool estimate(ProjectiveSystem& system, double dt, const StepReport& report);
  /// Whether the miss of one step is not yet believed of the ones before it, which nobody looked
  /// at, since `error` would follow.
  bool doubts(double error) const;

  StepErrorEstimate estimate_;
  double price_ = 1.0;
  bool is_watched_ = false;
  double lasting_ = 0.0;
  Told error_;                    // after the step that was estimated last
  std::uint64_t error_step_ = 0;  // that step; 0: none was estimated
  Told worst_;                    // the largest error so far, fading
  std::uint64_t worst_step_ = 0;  // the step until which it faded
  // When the next one is due.
  double least_ = 1.0;       // steps to it where somebody acts on it
  double credit_ = 0.0;      // work that may be spent [iterations]
  std::vector<int> active_;  // conditions of each constraint that carried force in the step before
  int burst_ = 0;            // steps in a row that are still to be estimated
  bool touches_ = false;     // something does since this step
  double unseen_ = 0.0;      // steps before the last estimates that are not counted yet
  int doubts_ = 0;           // estimates in a row that left some of them uncounted
};

}  // namespace pliant
