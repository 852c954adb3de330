#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/timer.h"

namespace pliant {

/// Which stopping rule ended a solver's iterations.
enum class EndedBy { kIterations, kTolerance, kBudget, kDirect };
std::string_view to_string(EndedBy ended_by);

struct PhaseTime {
  std::string_view name;  ///< a registry's or a literal's text: outlives the report
  double seconds = 0.0;
};

/// What one step did and what it cost. Reused from step to step, so that a step allocates nothing.
struct StepReport {
  std::string_view solver;
  std::uint64_t step = 0;  ///< number of this step, from 1
  double time = 0.0;       ///< simulated time at its end [s]
  double dt = 0.0;         ///< [s]
  int iterations = 0;
  double residual = 0.0;  ///< last iteration's displacement over the first one's
  EndedBy ended_by = EndedBy::kDirect;
  int contacts = 0;                   ///< contacts that carry force
  double seconds = 0.0;               ///< wall time of the step
  std::vector<PhaseTime> phases;      ///< solver phases and every effect that ran
  std::vector<std::string> warnings;  ///< empty in a normal step
  std::string failure;  ///< not empty: the step was undone; says where, when and what to try

  void begin(std::uint64_t step_number, double end_time, double step_size);
  void add_time(std::string_view name, double seconds);
  /// Adds `warning` unless this report has it.
  void warn(const std::string& warning);
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
