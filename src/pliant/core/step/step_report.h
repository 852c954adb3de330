#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/step/timer.h"

namespace pliant {

/// Which stopping rule ended a solver's iterations.
enum class EndedBy { kIterations, kTolerance, kBudget, kDirect, kRoundOff, kError };
std::string_view to_string(EndedBy ended_by);

/// As a table tells it: empty where there is none.
std::string text_of(const std::optional<double>& value);

struct PhaseTime {
  std::string_view name;  ///< a registry's or a literal's text: outlives the report
  double seconds = 0.0;
};

/// A number that one solver alone has to tell ("spectral_radius").
struct Metric {
  std::string_view name;  ///< a literal's text: outlives the report
  double value = 0.0;
};

/// What one step did and what it cost. Reused from step to step, so that a step allocates nothing.
struct StepReport {
  std::string_view solver;
  std::string_view backend = "cpu";   ///< where the solver ran: "cpu" or "cuda"
  std::string backend_reason;         ///< why there, where it had the choice; else empty
  std::string_view time_integration;  ///< empty: the solver has one of its own
  /// Why an integration of second order took this step by implicit Euler: "start", "impact",
  /// "energy", "liquid", "solvers"; empty: it did not.
  std::string_view first_order;
  std::uint64_t step = 0;  ///< number of this step, from 1
  double time = 0.0;       ///< simulated time at its end [s]
  double dt = 0.0;         ///< [s]
  int iterations = 0;
  /// |D^-1/2 (f - M a)| at the beginning of the last iteration over the largest part of that sum at
  /// the step's beginning: what share of the forces is not in balance.
  double residual = 0.0;
  /// Estimated distance of a body from where converged steps would have taken it, as a share of the
  /// distance that it came (solvers/checks/step_error.h), or a larger one of shortly before, which
  /// fades (solvers/checks/error_watch.h); empty: nothing estimates it. What steps missed was last
  /// looked at in step `error_step`.
  std::optional<double> error;
  std::uint64_t error_step = 0;
  /// Of what forces and contact change of a free body's momentum, the share that is missed
  /// (solvers/checks/impulse_imbalance.h); empty: there is no such body.
  std::optional<double> impulse_imbalance;
  /// Energy at the step's end that neither its beginning nor the work of forces explains [J], below
  /// 0 what the method damps (solvers/checks/step_energy.h); empty: it is not found, as without
  /// contact.
  std::optional<double> energy_gained;
  EndedBy ended_by = EndedBy::kDirect;
  int contacts = 0;                   ///< contacts that carry force
  double seconds = 0.0;               ///< wall time of the step
  std::vector<PhaseTime> phases;      ///< solver phases and every effect that ran
  std::vector<Metric> metrics;        ///< the solver's own
  std::vector<std::string> warnings;  ///< empty in a normal step
  std::string failure;  ///< not empty: the step was undone; says where, when and what to try

  void begin(std::uint64_t step_number, double end_time, double step_size);
  /// Before a further substep: what says how the solver fared is that of the last one.
  void begin_substep();
  /// How the solver fared that moves this body with that of `other`, where its time and its
  /// warnings stand.
  void take_solver_from(const StepReport& other);
  void add_time(std::string_view name, double seconds);
  void add_metric(std::string_view name, double value) { metrics.push_back({name, value}); }
  /// Forgets all warnings but the first `count`.
  void forget_warnings(std::size_t count);
  /// Adds `warning` unless this report has it.
  void warn(std::string_view warning);

 private:
  std::vector<std::string> spare_;  // memory of warnings of earlier steps
};

/// Adds the time it lives to a phase of a report.
class ScopedPhase {
 public:
  ScopedPhase(StepReport& report, std::string_view name) : report_(report), name_(name) {}
  ~ScopedPhase() { report_.add_time(name_, timer_.seconds()); }
  ScopedPhase(const ScopedPhase&) = delete;
  ScopedPhase& operator=(const ScopedPhase&) = delete;

 private:
  StepReport& report_;
  std::string_view name_;
  Timer timer_;
};

}  // namespace pliant
