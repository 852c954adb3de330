#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/cloth_lifts.h"
#include "pliant/study/experiments/cloth_study.h"

namespace pliant {
namespace {

/// The thesis's cloth with something changed.
struct ThesisLift {
  std::string name;
  int points;
  double air;  // [m³]
  int side;
  double shear;  // [N/m]
};

std::vector<ThesisLift> thesis_lifts() {
  std::vector<ThesisLift> all;
  for (const int points : {1, 2}) {
    for (const double air : {0.0, 4e-4}) all.push_back({"thesis", points, air, 50, 10});
  }
  for (const int side : {30, 31, 51}) {
    all.push_back({fmt::format("{} vertices a side", side), 1, 4e-4, side, 10});
  }
  for (const double shear : {1.0, 50.0}) {
    all.push_back({fmt::format("shear {:.0f} N/m", shear), 1, 4e-4, 50, shear});
  }
  return all;
}

}  // namespace

ClothLift::Options thesis_cloth(int side) {
  ClothLift::Options options;
  options.side = side;
  options.solver = "verlet";
  options.solver_parameters = {{"contact_sweeps", "1"}};
  options.time_step = 1.0 / 12000.0 * 49.0 / (side - 1);
  options.material = {{"areal_density", "0.1"},
                      {"stretch_warp", "100"},
                      {"stretch_weft", "100"},
                      {"shear", "10"},
                      {"bending", "0"}};
  return options;
}

bool study_cloth_thesis(const ExperimentOptions& study, const ExperimentProgress& progress) {
  LiftTables tables;
  const std::vector<ThesisLift> all = thesis_lifts();
  LiftMotion motion;
  motion.share = std::sqrt(study.share);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const ThesisLift& one = all[k];
    const double side = std::sqrt(study.share) * one.side;
    ClothLift::Options options = thesis_cloth(std::max(4, static_cast<int>(std::lround(side))));
    options.points = one.points;
    options.air = one.air;
    options.material["shear"] = fmt::format("{}", one.shear);
    const auto told = [&](double part) {
      return progress(
          (static_cast<double>(k) + part) / static_cast<double>(all.size()),
          fmt::format("{}, {} points, {:.0f} cm^3", one.name, one.points, 1e6 * one.air));
    };
    if (!tables.lift(options, motion, one.name, told)) return false;
  }
  write_file_atomically(study.folder + "/thesis.csv", tables.lifts);
  write_file_atomically(study.folder + "/thesis_folds.csv", tables.folds);
  write_file_atomically(study.folder + "/thesis_states.csv", tables.states);
  return true;
}

}  // namespace pliant
