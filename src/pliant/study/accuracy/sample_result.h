#pragma once

#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/accuracy_row.h"
#include "pliant/study/accuracy/error_meter.h"

namespace pliant {

/// What a solver did with one sample: a step from one state, or a whole run.
struct SampleResult {
  bool is_finite = true;
  Errors errors;                 ///< infinite when it is not finite
  double residual = 0.0;         ///< largest of a step
  double iterations = 0.0;       ///< most in a step
  double step_seconds = 0.0;     ///< median [s]
  double longest_seconds = 0.0;  ///< [s]
  double wall_seconds = 0.0;     ///< median, other programs included [s]
  double prepare_seconds = 0.0;  ///< to set the solver up [s]
};

/// Gives every body that solver; returns the wall time that took [s].
double set_solver(const SolverSetting& solver, World& world);
/// Errors of a state that blew up.
Errors infinite_errors();
/// Takes residual and iterations of the last step.
void add_reports(const World& world, SampleResult& result);
/// The row of `planned`: the largest errors, the median time.
AccuracyRow summary(const PlannedRow& planned, const std::vector<SampleResult>& samples);

/// "jacobi, 16 iterations, step of 0.005 s".
std::string label(const PlannedRow& planned);

}  // namespace pliant
