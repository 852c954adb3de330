#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/study/reduced_run.h"

namespace pliant {

/// The thesis's experiments with reduced bodies, and those that go past it. Each writes tables into
/// a folder that exists, and returns false when the progress function asked to stop.
struct ReducedStudyOptions {
  std::string folder;
  std::vector<std::string> bodies;  ///< names of examples
  double share = 0.1;               ///< peak displacement over body size; see make_study_body()
  double duration = 30.0;           ///< of experiments 1 and 2 [s]
  std::uint64_t long_steps = 3'000'000;
};
using StudyProgress = std::function<bool(double done, double total, const std::string& what)>;

/// 1 without and 2 with damping: three loads, at 1, 2 and 4 times their force; runs.csv and, at the
/// thesis's force, energy_<body>_<load>_<damping>.csv.
bool study_reduced_runs(const ReducedStudyOptions& options, const std::vector<double>& dampings,
                        const StudyProgress& progress);
/// 3: the quadruped after an impulse for a long time; long.csv.
bool study_reduced_long(const ReducedStudyOptions& options, const StudyProgress& progress);
/// 4: the beam at three time steps; steps.csv.
bool study_reduced_steps(const ReducedStudyOptions& options, const StudyProgress& progress);
/// Time of a step of each integrator on each body and load; speed.csv.
bool study_reduced_speed(const ReducedStudyOptions& options, const StudyProgress& progress);
/// One evaluation of the force at ranks 15, 30, 60 against what this machine's arithmetic and
/// memory can, both measured; floor.csv.
bool study_reduced_floor(const ReducedStudyOptions& options, const StudyProgress& progress);
/// Error of energy and of trajectory against time for all integrators and steps; precision.csv.
bool study_reduced_precision(const ReducedStudyOptions& options, const StudyProgress& progress);

}  // namespace pliant
