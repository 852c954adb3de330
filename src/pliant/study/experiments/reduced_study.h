#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/study/experiments/reduced_parts.h"
#include "pliant/study/experiments/reduced_run.h"

namespace pliant {

/// The thesis's experiments with reduced bodies, and those that go past it. Each writes tables into
/// a folder that exists, and returns false when the progress function asked to stop; what was
/// finished by then is kept in `parts` and not made again.
struct ReducedStudyOptions {
  std::string folder;
  std::vector<std::string> bodies;  ///< names of examples
  double share = 0.1;               ///< peak displacement over body size; see make_study_body()
  double duration = 30.0;           ///< of experiments 1, 2 and thesis [s]
  std::uint64_t long_steps = 3'000'000;
};
/// The text that parts must share: all options but the folder and which bodies.
std::string settings_of(const ReducedStudyOptions& options);

using StudyProgress = std::function<bool(double done, double total, const std::string& what)>;

/// The integrators that the experiments compare.
std::vector<StudyIntegrator> compared_integrators();
/// Elastic and kinetic energy [J].
double total_energy(const ReducedSystem& system);
/// Least time of a step in `repeats` runs [s]; `run` is the last.
double step_seconds(const StudyBody& body, const ReducedRunOptions& options, int repeats,
                    ReducedRun& run);

/// 1 without and 2 with damping: three loads, at 1, 2 and 4 times their force; runs_<damping>.csv
/// and, at the thesis's force, energy_<body>_<load>_<damping>.csv.
bool study_reduced_runs(const ReducedStudyOptions& options, const ReducedParts& parts,
                        double damping, const StudyProgress& progress);
/// 3: the quadruped after an impulse for a long time; long.csv, and energies in long_energy.csv.
bool study_reduced_long(const ReducedStudyOptions& options, const ReducedParts& parts,
                        const StudyProgress& progress);
/// 4: the beam at three time steps; steps.csv.
bool study_reduced_steps(const ReducedStudyOptions& options, const ReducedParts& parts,
                         const StudyProgress& progress);
/// The thesis's integrator with its counts of explicit coordinates, on our bodies and on bodies so
/// soft that these counts mean h ω < 1; with the largest h ω of the explicit part that is met;
/// thesis.csv.
bool study_reduced_thesis(const ReducedStudyOptions& options, const ReducedParts& parts,
                          const StudyProgress& progress);
/// How fast each coordinate that the thesis's step can show rings alone, at three amplitudes and
/// three steps, against a fine standard; frequencies.csv.
bool study_reduced_frequencies(const ReducedStudyOptions& options, const ReducedParts& parts,
                               const StudyProgress& progress);
/// Time of a step of each integrator on each body and load; speed.csv.
bool study_reduced_speed(const ReducedStudyOptions& options, const ReducedParts& parts,
                         const StudyProgress& progress);
/// One evaluation of the force at ranks 15, 30, 60 against what this machine's arithmetic and
/// memory can, both measured; floor.csv. It is one part.
bool study_reduced_floor(const ReducedStudyOptions& options, const StudyProgress& progress);
/// What the thesis shows as pictures: frames of the quadruped at 0, 3 and 16 s by `trigonometric`
/// and Newmark's method, the energy of the beam in its first second at three steps, and a run of
/// the thesis's integrator that blows up; frames.csv with frames_surface.csv, early.csv,
/// blow_up.csv.
bool study_reduced_pictures(const ReducedStudyOptions& options, const StudyProgress& progress);
/// Error of energy and of trajectory against time for all integrators and steps; precision.csv.
bool study_reduced_precision(const ReducedStudyOptions& options, const ReducedParts& parts,
                             const StudyProgress& progress);

}  // namespace pliant
