#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pliant {

/// The thesis's experiments with a wet cloth that is lifted off a table. Each writes tables into a
/// folder that exists, and returns false when the progress function asked to stop.
struct ClothStudyOptions {
  std::string folder;
  double share = 1.0;  ///< of the thesis's numbers of vertices and steps, in (0, 1]
};
using ClothProgress = std::function<bool(double done, const std::string& what)>;

struct ClothExperiment {
  std::string name, meaning;
  bool (*run)(const ClothStudyOptions& options, const ClothProgress& progress);
};
const std::vector<ClothExperiment>& cloth_experiments();

/// Lifted at one and at two points, with 0 and 400 cm³ of air: radius, bubbles and folds against
/// height in lift.csv, heights about the hand in folds.csv, the cloths' last states in
/// POINTS_AIR.csv.
bool study_cloth_lift(const ClothStudyOptions& options, const ClothProgress& progress);
/// Steps a second of verlet for 100 to 10,000 vertices, and of a step of 1/60 s; each effect's
/// share; speed.csv.
bool study_cloth_speed(const ClothStudyOptions& options, const ClothProgress& progress);

}  // namespace pliant
