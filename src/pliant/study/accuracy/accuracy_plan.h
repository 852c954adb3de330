#pragma once

#include <string>
#include <vector>

#include "pliant/scene/scene_spec.h"
#include "pliant/study/accuracy/accuracy_options.h"
#include "pliant/study/accuracy/accuracy_row.h"

namespace pliant {

/// A solver as a study runs it.
struct SolverSetting {
  std::string name;
  ParameterText parameters;
  int iterations = 0;                 ///< 0: the solver has no such parameter
  std::string time_integration = {};  ///< of a whole run; "": the scene's

  /// What rows call it: "newton", "newton by bdf2".
  std::string label() const {
    return time_integration.empty() ? name : name + " by " + time_integration;
  }
};

/// A row that a study has to measure.
struct PlannedRow {
  Measure measure;
  SolverSetting solver;
  double time_step;                   ///< [s]
  std::string time_integration = {};  ///< as AccuracyRow names it
};

/// An accuracy study, checked: what it measures and against which references.
struct AccuracyPlan {
  SceneSpec scene;
  AccuracyOptions options;           ///< with every default filled in
  int steps = 0;                     ///< of the scene's time step
  double duration = 0.0;             ///< steps times the scene's time step [s]
  SolverSetting runner;              ///< takes the scene from sample to sample
  double reference_time_step = 0.0;  ///< of whole runs [s]; 0 without them
  std::vector<PlannedRow> rows;
  std::vector<std::string> notes;  ///< what was left out, and why
};

/// How many times smaller the reference's time step is than the smallest of the whole runs.
constexpr int kReferenceDivisor = 4;

/// Throws InputError for a solver that is unknown or does not suit a body's model, for a duration
/// that is no whole number of a time step, for fewer steps than samples, and for references that
/// are no converging solvers or equal.
AccuracyPlan make_accuracy_plan(const SceneSpec& scene, const AccuracyOptions& options);

/// The solver `name` with `iterations` (none when the solver takes none). Of the scene's own
/// solver all parameters but the stop rules are kept.
SolverSetting solver_setting(const SceneSpec& scene, const std::string& name, int iterations);

/// The scene with that solver and time step.
SceneSpec scene_with(const SceneSpec& scene, const SolverSetting& solver, double time_step);

/// What a solver's steps of the scene are integrated by, as AccuracyRow names it.
std::string integration_name(const SceneSpec& scene, const SolverSetting& solver);

/// Whether a solver iterates on the implicit step; the others are explicit.
bool takes_iterations(const std::string& solver);

}  // namespace pliant
