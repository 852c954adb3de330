#include "pliant/study/experiments/cloth_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/cloth_scene.h"
#include "pliant/study/experiments/cloth_shape.h"

namespace pliant {
namespace {

// The hand's rise [m/s] and how high it comes [m].
constexpr double kSpeed = 0.05, kHeight = 0.05;
// When it begins: what air there is has come in and the cloth rests [s].
constexpr double kBegin = 0.5;
// Above what lies, from which on it counts as lifted; and circle on which folds are looked for [m].
constexpr double kLifted = 0.001, kCircle = 0.04;
constexpr double kFrame = 1.0 / 60.0;  // [s]
// Along warp and weft, where a limit holds.
constexpr double kMaxStretch = 1.01;
// Steps before any that are timed.
constexpr int kMostBefore = 4000;

int scaled(double count, double share) {
  return std::max(1, static_cast<int>(std::lround(count * share)));
}

/// Largest stretch of an edge along warp or weft, as a share.
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

struct Tables {
  std::string lift =
      "points,air_cm3,height_mm,wetted_radius_mm,bubbles,volume_cm3,pressure_pa,strain,folds,"
      "directions_deg\n";
  std::string folds = "points,air_cm3,angle_deg,height_mm\n";
};

void add_row(const ClothLift::Options& options, double height, ClothLift& lift, bool is_last,
             Tables& tables) {
  const Positions& x = lift.body().particles().x;
  const double ground = 0.5 * ClothLift::kThickness;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const int i : lift.held())
    middle += x.col(i).head<2>() / static_cast<double>(options.points);
  const Folds folds = find_folds(lift.grid(), x, middle, kCircle);
  tables.lift +=
      fmt::format("{},{:.0f},{:.2f},{:.2f},{},{:.3f},{:.1f},{:.4f},{},{:.0f}\n", options.points,
                  1e6 * options.air, 1e3 * height,
                  1e3 * wetted_radius(lift.body().model->particle_areas(), x, ground + kLifted),
                  lift.air().bubbles().size(), 1e6 * lift.air().volume(x), lift.air().pressure(),
                  largest_strain(lift), folds.directions.size(), fmt::join(folds.directions, " "));
  if (!is_last) return;
  const double turn = 360.0 / static_cast<double>(folds.heights.size());
  for (std::size_t k = 0; k < folds.heights.size(); ++k) {
    tables.folds += fmt::format("{},{:.0f},{:.0f},{:.3f}\n", options.points, 1e6 * options.air,
                                turn * static_cast<double>(k), 1e3 * folds.heights[k]);
  }
}

void write_state(const ExperimentOptions& study, const ClothLift::Options& options,
                 ClothLift& lift) {
  std::string table = "row,column,x_m,y_m,z_m\n";
  const Positions& x = lift.body().particles().x;
  for (int i = 0; i < x.cols(); ++i) {
    table += fmt::format("{},{},{:.6f},{:.6f},{:.6f}\n", i / options.side, i % options.side,
                         x(0, i), x(1, i), x(2, i));
  }
  write_file_atomically(
      fmt::format("{}/{}_{:.0f}.csv", study.folder, options.points, 1e6 * options.air), table);
}

/// Satin: wet it weighs twice its dry weight.
ParameterText satin() {
  return {{"areal_density", "0.2"},
          {"stretch_warp", "1000"},
          {"stretch_weft", "1000"},
          {"shear", "50"},
          {"bending", "1e-5"}};
}

// As in bench/cloth_bench.cpp: fewer or more vertices keep the stability number of 2,500.
ClothLift::Options thesis_step(int side) {
  ClothLift::Options options;
  options.side = side;
  options.air = 4e-4;
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

ClothLift::Options frame_step(int side) {
  ClothLift::Options options;
  options.side = side;
  options.air = 4e-4;
  options.time_step = kFrame;
  options.solver_parameters = {{"iterations", "15"}};
  options.material = satin();
  options.max_stretch = kMaxStretch;
  return options;
}

/// Mean times of `steps` steps, or fewer where the hand is up before.
std::string measure(const ClothLift::Options& options, int steps) {
  ClothLift lift(options);
  const double way = kSpeed * options.time_step;
  const int begin = std::min(kMostBefore, static_cast<int>(std::ceil(kBegin / options.time_step)));
  for (int k = 0; k < begin; ++k) lift.step(0.0);
  const int counted = std::min(steps, static_cast<int>(kHeight / way));
  StepReport sum;
  double seconds = 0.0, strain = 0.0;
  for (int k = 0; k < counted; ++k) {
    if (!lift.step(way)) break;
    const StepReport& report = lift.body().report;
    seconds += report.seconds;
    for (const PhaseTime& phase : report.phases) sum.add_time(phase.name, phase.seconds);
    strain = std::max(strain, largest_strain(lift));
  }
  std::string shares;
  for (const PhaseTime& phase : sum.phases) {
    shares += fmt::format("{}{} {:.0f} %", shares.empty() ? "" : "; ", phase.name,
                          100.0 * phase.seconds / seconds);
  }
  return fmt::format("{},{},{:.3g},{:.1f},{:.3f},{:.4f},\"{}\"\n", options.side * options.side,
                     options.solver, options.time_step, counted / seconds,
                     counted * options.time_step / seconds, strain, shares);
}

}  // namespace

const std::vector<Experiment>& cloth_experiments() {
  static const std::vector<Experiment> all = {
      {"lift", "lifted at one and two points, with 0 and 400 cm^3 of air", study_cloth_lift},
      {"speed", "steps a second with 100 to 10,000 vertices, and each effect's share",
       study_cloth_speed},
  };
  return all;
}

bool study_cloth_lift(const ExperimentOptions& study, const ExperimentProgress& progress) {
  Tables tables;
  double done = 0.0;
  for (const int points : {1, 2}) {
    for (const double air : {0.0, 4e-4}) {
      ClothLift::Options options;
      options.side = scaled(50, std::sqrt(study.share));
      options.points = points;
      options.air = air;
      options.time_step = 1.0 / 300.0;
      options.solver_parameters = {{"iterations", "60"}};
      options.material = satin();
      options.max_stretch = kMaxStretch;
      ClothLift lift(options);
      const int begin = scaled(kBegin / options.time_step, study.share);
      const int steps = scaled(kHeight / kSpeed / options.time_step, study.share);
      for (int k = 0; k < begin + steps; ++k) {
        if (k % 10 == 0) {
          const double part = static_cast<double>(k) / (begin + steps);
          if (!progress((done + part) / 4.0,
                        fmt::format("{} points, {:.0f} cm^3", points, 1e6 * air))) {
            return false;
          }
        }
        const double way = k < begin ? 0.0 : kHeight / steps;
        if (!lift.step(way)) break;
        const int risen = k + 1 - begin;
        if (risen >= 0 && risen % std::max(1, steps / 10) == 0) {
          add_row(options, kHeight * risen / steps, lift, risen == steps, tables);
        }
      }
      write_state(study, options, lift);
      done += 1.0;
    }
  }
  write_file_atomically(study.folder + "/lift.csv", tables.lift);
  write_file_atomically(study.folder + "/folds.csv", tables.folds);
  return true;
}

bool study_cloth_speed(const ExperimentOptions& study, const ExperimentProgress& progress) {
  std::string table = "vertices,solver,step_s,steps_per_second,real_time_factor,strain,shares\n";
  const std::vector<int> sides = {10, 20, 30, 40, 50, 100};
  double done = 0.0;
  for (const bool is_explicit : {true, false}) {
    for (const int side : sides) {
      const int own = std::max(4, scaled(side, std::sqrt(study.share)));
      const ClothLift::Options options = is_explicit ? thesis_step(own) : frame_step(own);
      if (!progress(done / 12.0, fmt::format("{} vertices, {}", own * own, options.solver))) {
        return false;
      }
      done += 1.0;
      table += measure(options, scaled(1000, study.share));
    }
  }
  write_file_atomically(study.folder + "/speed.csv", table);
  return true;
}

}  // namespace pliant
