#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace pliant {

/// One number of a source, and the library's.
struct JudgedFigure {
  std::string quantity, unit;
  double reference = 0.0;
  double ours = std::numeric_limits<double>::quiet_NaN();  ///< not finite: it was not found
  /// Ours at half of the resolution in space, so that one sees where it goes; not finite: not
  /// taken.
  double coarser = std::numeric_limits<double>::quiet_NaN();

  /// |ours - reference| / |reference|; infinite where ours is not finite.
  double error() const;
  double coarser_error() const;
};

struct JudgeOptions {
  std::string folder;  ///< for curves, as CSV; empty: none are written
  /// Told how much of a judge is done, in [0, 1]; false asks it to stop: it then returns what it
  /// likes, which nobody reads.
  std::function<bool(double done)> go_on = [](double) { return true; };
};

/// A case of the literature, set up as its source has it.
struct Judge {
  std::string name, source, set_up;
  /// Error beyond which a figure is a miss: 0.05 of what was computed or has a closed form, 0.1 of
  /// what was measured, since two experiments differ by half of that.
  double allowed = 0.05;
  bool is_quick = false;  ///< takes about a second
  /// Throws where the library fails.
  std::vector<JudgedFigure> (*run)(const JudgeOptions& options) = nullptr;
  bool is_drawn = false;  ///< scripts/plot_judges draws its curve
};

constexpr double kComputed = 0.05, kMeasured = 0.1;

/// In the order of the documentation.
const std::vector<Judge>& judges();

// Solids.
Judge cooks_membrane_judge();
Judge hertz_judge();
Judge torsion_judge();
Judge twisting_column_judge();
Judge elastic_flag_statics_judge();
Judge elastic_flag_judge();
// Liquids.
Judge liquid_at_rest_judge();
Judge dam_break_front_judge();
Judge dam_break_pressure_judge();
// Fabrics.
Judge fabric_cantilever_judge();
Judge drape_judge();

}  // namespace pliant
