#include "pliant/study/experiments/cloth_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/cloth_lifts.h"

namespace pliant {
namespace {

constexpr double kFrame = 1.0 / 60.0;  // [s]
// Along warp and weft, where a limit holds.
constexpr double kMaxStretch = 1.01;
// Steps before any that are timed.
constexpr int kMostBefore = 4000;

int scaled(double count, double share) {
  return std::max(1, static_cast<int>(std::lround(count * share)));
}

/// Satin: wet it weighs twice its dry weight.
ParameterText satin() {
  return {{"areal_density", "0.2"},
          {"stretch_warp", "1000"},
          {"stretch_weft", "1000"},
          {"shear", "50"},
          {"bending", "1e-5"}};
}

ClothLift::Options frame_step(int side) {
  ClothLift::Options options;
  options.side = side;
  options.time_step = kFrame;
  options.solver_parameters = {{"iterations", "15"}};
  options.material = satin();
  options.max_stretch = kMaxStretch;
  return options;
}

/// Mean times of `steps` steps, or fewer where the hand is up before.
std::string measure(const ClothLift::Options& options, int steps) {
  ClothLift lift(options);
  const LiftMotion motion;
  const double rise = motion.speed * options.time_step;
  const int begin =
      std::min(kMostBefore, static_cast<int>(std::ceil(motion.begin / options.time_step)));
  for (int k = 0; k < begin; ++k) lift.step(0.0);
  const int counted = std::min(steps, static_cast<int>(motion.height / rise));
  StepReport sum;
  double seconds = 0.0, strain = 0.0;
  for (int k = 0; k < counted; ++k) {
    if (!lift.step(rise)) break;
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
      {"thesis", "lifted as in the thesis: its springs, Verlet, steps of 1/12,000 s",
       study_cloth_thesis},
      {"lift", "lifted at one and two points, with 0 and 400 cm^3 of air", study_cloth_lift},
      {"speed", "steps a second with 100 to 10,000 vertices, and each effect's share",
       study_cloth_speed},
  };
  return all;
}

bool study_cloth_lift(const ExperimentOptions& study, const ExperimentProgress& progress) {
  LiftTables tables;
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
      LiftMotion motion;
      motion.share = study.share;
      const auto told = [&](double part) {
        return progress((done + part) / 4.0,
                        fmt::format("{} points, {:.0f} cm^3", points, 1e6 * air));
      };
      if (!tables.lift(options, motion, "satin", told)) return false;
      write_file_atomically(fmt::format("{}/{}_{:.0f}.csv", study.folder, points, 1e6 * air),
                            tables.last_state);
      done += 1.0;
    }
  }
  write_file_atomically(study.folder + "/lift.csv", tables.lifts);
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
      ClothLift::Options options = is_explicit ? thesis_cloth(own) : frame_step(own);
      options.air = 4e-4;
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
