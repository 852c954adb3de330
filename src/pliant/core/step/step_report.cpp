#include "pliant/core/step/step_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace pliant {

std::string_view to_string(EndedBy ended_by) {
  switch (ended_by) {
    case EndedBy::kIterations:
      return "iterations";
    case EndedBy::kTolerance:
      return "tolerance";
    case EndedBy::kBudget:
      return "budget";
    case EndedBy::kDirect:
      return "direct";
    case EndedBy::kRoundOff:
      return "round-off";
    case EndedBy::kError:
      return "error";
  }
  return "unknown";
}

std::string text_of(const std::optional<double>& value) {
  return value ? fmt::to_string(*value) : "";
}

void StepReport::begin(std::uint64_t step_number, double end_time, double step_size) {
  step = step_number;
  time = end_time;
  dt = step_size;
  seconds = 0.0;
  phases.clear();
  std::move(warnings.begin(), warnings.end(), std::back_inserter(spare_));
  warnings.clear();
  failure.clear();
  time_integration = first_order = {};
  error.reset();
  error_step = 0;
  impulse_imbalance.reset();
  energy_gained.reset();
  begin_substep();
}

void StepReport::begin_substep() {
  iterations = 0;
  residual = 0.0;
  ended_by = EndedBy::kDirect;
  contacts = 0;
  metrics.clear();
  backend = "cpu";
  backend_reason.clear();
}

void StepReport::take_solver_from(const StepReport& other) {
  solver = other.solver;
  time_integration = other.time_integration;
  first_order = other.first_order;
  backend = other.backend;
  backend_reason = other.backend_reason;
  iterations = other.iterations;
  residual = other.residual;
  error = other.error;
  error_step = other.error_step;
  impulse_imbalance = other.impulse_imbalance;
  ended_by = other.ended_by;
}

void StepReport::add_time(std::string_view name, double elapsed) {
  for (PhaseTime& phase : phases) {
    if (phase.name == name) {
      phase.seconds += elapsed;
      return;
    }
  }
  phases.push_back({name, elapsed});
}

void StepReport::forget_warnings(std::size_t count) {
  while (warnings.size() > count) {
    spare_.push_back(std::move(warnings.back()));
    warnings.pop_back();
  }
}

void StepReport::warn(std::string_view warning) {
  if (std::find(warnings.begin(), warnings.end(), warning) != warnings.end()) return;
  if (spare_.empty()) spare_.emplace_back();
  warnings.push_back(std::move(spare_.back()));
  spare_.pop_back();
  warnings.back() = warning;
}

}  // namespace pliant
