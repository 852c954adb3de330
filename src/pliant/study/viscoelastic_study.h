#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pliant {

/// The paper's experiments with bodies between rigid and liquid, and those that go past it. Each
/// writes a table into a folder that exists, and returns false when the progress function asked to
/// stop.
struct ViscoelasticStudyOptions {
  std::string folder;
  double share = 1.0;  ///< of the paper's numbers of particles and steps, in (0, 1]
};
using ViscoelasticProgress = std::function<bool(double done, const std::string& what)>;

struct ViscoelasticExperiment {
  std::string name, meaning;
  bool (*run)(const ViscoelasticStudyOptions& options, const ViscoelasticProgress& progress);
};
const std::vector<ViscoelasticExperiment>& viscoelastic_experiments();

/// Iterations that each solver takes to the same residual, over 140 steps of a loaded bar;
/// solvers.csv.
bool study_viscoelastic_solvers(const ViscoelasticStudyOptions& options,
                                const ViscoelasticProgress& progress);
/// 6525 particles with all, 2106 and 889 clusters: iterations inside 33 ms, stiffness seen;
/// clusters.csv.
bool study_viscoelastic_clusters(const ViscoelasticStudyOptions& options,
                                 const ViscoelasticProgress& progress);
/// A thin plate of 832 particles, with shape matching and with oriented particles; thin.csv.
bool study_viscoelastic_thin(const ViscoelasticStudyOptions& options,
                             const ViscoelasticProgress& progress);
/// QLERP against the exponential map over the clusters of a bent bar; interpolation.csv.
bool study_viscoelastic_interpolation(const ViscoelasticStudyOptions& options,
                                      const ViscoelasticProgress& progress);
/// Steps a second of each state, and each phase's share; speed.csv.
bool study_viscoelastic_speed(const ViscoelasticStudyOptions& options,
                              const ViscoelasticProgress& progress);

}  // namespace pliant
