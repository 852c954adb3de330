#pragma once

#include <vector>

#include "pliant/models/viscoelastic/viscoelastic.h"
#include "pliant/study/experiments/experiment.h"

namespace pliant {

/// The paper's experiments with bodies between rigid and liquid, and those that go past it.
const std::vector<Experiment>& viscoelastic_experiments();

/// Iterations that each solver takes to the same residual, over 140 steps of a loaded bar;
/// solvers.csv.
bool study_viscoelastic_solvers(const ExperimentOptions& options,
                                const ExperimentProgress& progress);
/// Iterations that shape matching takes to the same mean strain of its clusters, by Jacobi, with
/// weights, by Gauss-Seidel and the hybrid of both; shape_matching.csv.
bool study_viscoelastic_shape_matching(const ExperimentOptions& options,
                                       const ExperimentProgress& progress);
/// 6525 particles with all, 2106 and 889 clusters: iterations inside 33 ms, stiffness seen;
/// clusters.csv.
bool study_viscoelastic_clusters(const ExperimentOptions& options,
                                 const ExperimentProgress& progress);
/// A closed figure of 6,525 particles with all, 2,106 and 889 clusters, without orientations and
/// with both means of them: iterations inside 33 ms, how it bends; figure.csv, centres.csv.
bool study_viscoelastic_figure(const ExperimentOptions& options,
                               const ExperimentProgress& progress);
/// The figure in the four states, dropped: where its particles are; states.csv.
bool study_viscoelastic_states(const ExperimentOptions& options,
                               const ExperimentProgress& progress);
/// The bent figure's mesh, carried by all and by sampled clusters, by the nearest alone and by both
/// means of turns: rendering.csv and rendering_CLUSTERS_BLEND.obj.
bool study_viscoelastic_rendering(const ExperimentOptions& options,
                                  const ExperimentProgress& progress);
/// A thin plate of 832 particles, with shape matching and with oriented particles, by the paper's
/// iterations and with a modulus: thin.csv, and where its particles end in plates.csv.
bool study_viscoelastic_thin(const ExperimentOptions& options, const ExperimentProgress& progress);
/// QLERP against the exponential map over the clusters of a bent bar; interpolation.csv.
bool study_viscoelastic_interpolation(const ExperimentOptions& options,
                                      const ExperimentProgress& progress);
/// Steps a second of each state, and each phase's share; speed.csv.
bool study_viscoelastic_speed(const ExperimentOptions& options, const ExperimentProgress& progress);

/// A material in one of the four states: rigid, elastic, viscoelastic or liquid.
ViscoelasticModel::Material material_of_state(const std::string& state);

}  // namespace pliant
