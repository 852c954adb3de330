#include "pliant/study/experiments/cloth_lifts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pliant/study/experiments/cloth_shape.h"

namespace pliant {
namespace {

// Above what lies, from which on it counts as lifted; and circle on which folds are looked for [m].
constexpr double kLifted = 0.001, kCircle = 0.04;
// Rows of a lift.
constexpr int kRows = 10;

int steps_of(double seconds, const ClothLift::Options& options, double share) {
  return std::max(1, static_cast<int>(std::lround(seconds / options.time_step * share)));
}

Folds folds_of(ClothLift& lift) {
  const Positions& x = lift.body().particles().x;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const int i : lift.held()) middle += x.col(i).head<2>();
  return find_folds(lift.grid(), x, middle / static_cast<double>(lift.held().size()), kCircle);
}

}  // namespace

double largest_strain(ClothLift& lift) {
  const GridOptions& grid = lift.grid();
  const Positions& x = lift.body().particles().x;
  const double cell = ClothLift::kWidth / (grid.columns - 1);
  double largest = 0.0;
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const int along = r * grid.columns + c, across = c * grid.columns + r;
      largest = std::max({largest, (x.col(along + 1) - x.col(along)).norm() / cell - 1.0,
                          (x.col(across + grid.columns) - x.col(across)).norm() / cell - 1.0});
    }
  }
  return largest;
}

bool LiftTables::lift(const ClothLift::Options& options, const LiftMotion& motion,
                      const std::string& name, const std::function<bool(double)>& progress) {
  ClothLift lift(options);
  const int begin = steps_of(motion.begin, options, motion.share);
  const int steps = steps_of(motion.height / motion.speed, options, motion.share);
  for (int k = 0; k < begin + steps; ++k) {
    if (k % 10 == 0 && !progress(static_cast<double>(k) / (begin + steps))) return false;
    if (!lift.step(k < begin ? 0.0 : motion.height / steps)) break;
    const int risen = k + 1 - begin;
    // Whole tenths of the rise: where the steps do not make them, the first step beyond.
    const int row = risen * kRows / steps;
    if (risen < 0 || (risen > 0 && row == (risen - 1) * kRows / steps)) continue;
    const double height = motion.height * risen / steps;
    add_row(options, name, height, lift);
    if (row == kRows / 5 || row == kRows / 2 || row == kRows) {
      add_state(options, name, height, lift.body().particles().x);
    }
  }
  const Folds found = folds_of(lift);
  const double turn = 360.0 / static_cast<double>(found.heights.size());
  for (std::size_t k = 0; k < found.heights.size(); ++k) {
    folds += fmt::format("{},{},{:.0f},{:.0f},{:.3f}\n", name, options.points, 1e6 * options.air,
                         turn * static_cast<double>(k), 1e3 * found.heights[k]);
  }
  last_state = "row,column,x_m,y_m,z_m\n";
  const Positions& x = lift.body().particles().x;
  for (int i = 0; i < x.cols(); ++i) {
    last_state += fmt::format("{},{},{:.6f},{:.6f},{:.6f}\n", i / options.side, i % options.side,
                              x(0, i), x(1, i), x(2, i));
  }
  return true;
}

void LiftTables::add_row(const ClothLift::Options& options, const std::string& name, double height,
                         ClothLift& lift) {
  const Positions& x = lift.body().particles().x;
  const double ground = 0.5 * ClothLift::kThickness;
  const Folds found = folds_of(lift);
  lifts +=
      fmt::format("{},{},{:.0f},{:.2f},{:.2f},{},{:.3f},{:.1f},{:.4f},{},{:.0f}\n", name,
                  options.points, 1e6 * options.air, 1e3 * height,
                  1e3 * wetted_radius(lift.body().model->particle_areas(), x, ground + kLifted),
                  lift.air().bubbles().size(), 1e6 * lift.air().volume(x), lift.air().pressure(),
                  largest_strain(lift), found.directions.size(), fmt::join(found.directions, " "));
}

void LiftTables::add_state(const ClothLift::Options& options, const std::string& name,
                           double height, const Positions& x) {
  for (int i = 0; i < x.cols(); ++i) {
    states += fmt::format("{},{},{:.0f},{:.1f},{},{},{:.5f},{:.5f},{:.5f}\n", name, options.points,
                          1e6 * options.air, 1e3 * height, i / options.side, i % options.side,
                          x(0, i), x(1, i), x(2, i));
  }
}

}  // namespace pliant
