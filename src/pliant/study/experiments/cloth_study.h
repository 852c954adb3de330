#pragma once

#include <vector>

#include "pliant/study/experiments/cloth_scene.h"
#include "pliant/study/experiments/experiment.h"

namespace pliant {

/// The thesis's experiments with a wet cloth that is lifted off a table.
const std::vector<Experiment>& cloth_experiments();

/// The thesis's cloth and step: springs along warp, weft and both diagonals, no bending, Verlet at
/// 1/12,000 s. Fewer or more vertices a side than 50 keep the stability number of that.
ClothLift::Options thesis_cloth(int side);

/// Lifted as the thesis does it, at one and two points with 0 and 400 cm³ of air, then with other
/// meshes and shear: thesis.csv, thesis_folds.csv, thesis_states.csv.
bool study_cloth_thesis(const ExperimentOptions& options, const ExperimentProgress& progress);
/// The same of our satin: lifted at one and at two points, with 0 and 400 cm³ of air: radius,
/// bubbles and folds against height in lift.csv, heights about the hand in folds.csv, the cloths'
/// last states in POINTS_AIR.csv.
bool study_cloth_lift(const ExperimentOptions& options, const ExperimentProgress& progress);
/// Steps a second of verlet for 100 to 10,000 vertices, and of a step of 1/60 s; each effect's
/// share; speed.csv.
bool study_cloth_speed(const ExperimentOptions& options, const ExperimentProgress& progress);

}  // namespace pliant
