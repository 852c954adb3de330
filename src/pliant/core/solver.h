#pragma once

#include <string_view>

#include "pliant/core/registry.h"
#include "pliant/core/state_archive.h"
#include "pliant/core/step/resident_run.h"
#include "pliant/core/step/step_report.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// When an iterative solver stops: whichever rule is met first.
struct StopRule {
  int iterations = 10;
  double tolerance = 0.0;       ///< of the relative residual; 0 switches the rule off
  double budget = 0.0;          ///< wall time of the iterations [s]; 0 switches the rule off
  double error = 0.0;           ///< of StepReport::error; 0 switches the rule off
  int most_iterations = 20000;  ///< where `error` sets them
};

/// The three stop rules as parameters, and back.
std::vector<ParameterSpec> stop_rule_parameters(const std::string& default_iterations);
StopRule stop_rule(const Parameters& parameters);

class SolverBatch;

/// Advances a system by one time step; knows no model. Positions and velocities live in the system:
/// a swap to another solver loses nothing but what this one learned to be quick.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual std::string_view name() const = 0;
  /// What does the same on the CPU: itself, but for those that run elsewhere.
  virtual Solver& on_cpu() { return *this; }
  /// What it can be beside others where bodies in contact have different ones.
  enum class InLockstep { kNothing, kSweeps, kCorrections, kStepsOfItsOwn };
  virtual InLockstep in_lockstep() const { return InLockstep::kNothing; }
  /// Whether its steps bear forces as stiff as they come.
  virtual bool is_implicit() const { return true; }
  /// In how many substeps a step of `dt` [s] has to be taken so that none is too long for it, as
  /// far as its parameters allow; for the system that it was prepared with last.
  virtual int substeps_of_step(double /*dt*/) const { return 1; }
  /// Whether its iterations run on a GPU at present.
  virtual bool runs_on_gpu() const { return false; }
  /// Makes it one of the batch, which must outlive it and shares iterations on a GPU with those of
  /// other worlds; it has to be prepared again. False for one that steps as it does alone.
  virtual bool join(SolverBatch& /*batch*/) { return false; }
  /// Whether its steps are those of implicit Euler, from which other integrations are made
  /// (time_integration.h).
  virtual bool takes_time_integration() const { return false; }
  /// Whether the last step went less far than its iterations would have taken it, so as not to gain
  /// energy.
  virtual bool held_back() const { return false; }
  /// The system's structure (elements, masses, fixed particles) or the time step changed.
  virtual void prepare(System& system, double dt) = 0;
  virtual void step(System& system, double dt, StepReport& report) = 0;
  /// The same step in two halves, for solvers that share the work between them with those of other
  /// worlds (solver_batch.h); for others all of it is in the second.
  virtual void begin_step(System& /*system*/, double /*dt*/, StepReport& /*report*/) {}
  virtual void finish_step(System& system, double dt, StepReport& report) {
    step(system, dt, report);
  }
  /// How many steps of `run`, at most all of them, it can take on end while the state stays where
  /// it computes; below 2: none. begin_resident_run(), then what solvers of a batch share, then
  /// finish_resident_run() take them.
  virtual int resident_limit(const System& /*system*/, const ResidentRun& /*run*/) { return 0; }
  virtual void begin_resident_run(System& /*system*/, const ResidentRun& /*run*/,
                                  StepReport& /*report*/) {}
  /// Returns how many steps it took: fewer where the model has to look before the next one. Adds
  /// the forces on obstacles in the last step. 0: the steps could not be taken so, and the system
  /// is as it was.
  virtual int finish_resident_run(System& /*system*/, std::vector<Reaction>& /*reactions*/,
                                  StepReport& /*report*/) {
    return 0;
  }
  /// How much of the state where the last resident run ended is available to the host: what was to
  /// be read back (ResidentRun::readback), or more.
  virtual Readback available() const { return Readback::kState; }
  /// Where available() is kSurface: its vertices there [m].
  virtual const Positions* seen_surface() const { return nullptr; }
  /// Reads back the rest. False: that is lost, and the system is as it was last read back.
  virtual bool read_back_state(System& /*system*/) { return false; }
  /// What it learned of the system from one step to the next, and back; load() follows prepare().
  virtual void save(StateArchive& /*numbers*/) const {}
  virtual void load(StateArchive& /*numbers*/) {}
};

using SolverRegistry = Registry<Solver>;

}  // namespace pliant
