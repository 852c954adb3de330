#pragma once

#include <string>
#include <vector>

namespace pliant {

/// What an error is an error of: one time step from states of the reference's run, or the end of
/// a whole run.
enum class Measure { kStep, kRun };
std::string to_string(Measure measure);

/// One line of a study: a solver at one setting. Errors of steps are the largest over the samples.
/// Times come last: everything else is the same whenever and wherever the study runs.
struct AccuracyRow {
  Measure measure = Measure::kStep;
  std::string solver;
  std::string time_integration;  ///< its name; "own": the solver's, "bodies'": bodies differ
  int iterations = 0;            ///< asked for; 0: the solver takes none
  double time_step = 0.0;        ///< [s]
  bool is_finite = true;         ///< false: the solver blew up, errors are infinite

  double error = 0.0;            ///< relative position error
  double median_error = 0.0;     ///< over the samples
  double rms = 0.0;              ///< position error [m]
  double largest = 0.0;          ///< position error of a vertex [m]
  double energy_error = 0.0;     ///< relative
  double strain_error = 0.0;     ///< of the largest strain
  double residual = 0.0;         ///< largest that the solver reported
  double used_iterations = 0.0;  ///< most that the solver took in a step
  double states = 1.0;           ///< samples that count
  double disagreement = 0.0;     ///< relative position difference of the references

  double step_seconds = 0.0;        ///< median time of a step (StepTimes) [s]
  double longest_seconds = 0.0;     ///< of a sample's median, or of a step of a run [s]
  double seconds_per_second = 0.0;  ///< time for a simulated second
  double wall_seconds = 0.0;        ///< as step_seconds, with what other programs took [s]
  double prepare_seconds = 0.0;     ///< wall time to set the solver up [s]

  /// Whether the solver ended by itself every time: more iterations would change nothing.
  bool is_converged() const { return is_finite && used_iterations < iterations; }
  /// Whether the error is known to within a half: it is more than twice what the references
  /// disagree by.
  bool is_resolved() const { return !is_finite || error > 2.0 * disagreement; }
};

/// Comma-separated text with one header line; doubles are exact.
std::string to_csv(const std::vector<AccuracyRow>& rows);
/// Throws InputError "FILE:LINE: ..." for text that to_csv() did not write. An unfinished last line
/// cannot be: the file is replaced as a whole.
std::vector<AccuracyRow> rows_from_csv(const std::string& text, const std::string& file);

}  // namespace pliant
