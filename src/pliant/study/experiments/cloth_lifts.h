#pragma once

#include <string>

#include "pliant/study/experiments/cloth_scene.h"
#include "pliant/study/experiments/experiment.h"

namespace pliant {

/// Largest stretch of an edge along warp or weft, as a share.
double largest_strain(ClothLift& lift);

/// How a cloth is lifted: it rests for `begin` [s] while its air comes in, then the hand rises by
/// `height` [m] at `speed` [m/s].
struct LiftMotion {
  double begin = 0.5, height = 0.05, speed = 0.05;
  double share = 1.0;  ///< of both parts, for a quick look
};

/// What lifts have shown, as tables in CSV.
class LiftTables {
 public:
  /// One lift, told of ten times as it rises; false where `progress`, told the share of it that is
  /// done, asked to stop.
  bool lift(const ClothLift::Options& options, const LiftMotion& motion, const std::string& name,
            const std::function<bool(double)>& progress);

  /// Radius, air, strain and folds against the hand's height.
  std::string lifts =
      "name,points,air_cm3,height_mm,wetted_radius_mm,bubbles,volume_cm3,pressure_pa,strain,"
      "folds,directions_deg\n";
  /// At the end, heights 4 cm beside the hand, against the direction.
  std::string folds = "name,points,air_cm3,angle_deg,height_mm\n";
  /// Of all lifts, vertices at a fifth, a half and the whole of the rise.
  std::string states = "name,points,air_cm3,rise_mm,row,column,x_m,y_m,z_m\n";
  /// The last state of the last lift.
  std::string last_state;

 private:
  void add_row(const ClothLift::Options& options, const std::string& name, double height,
               ClothLift& lift);
  void add_state(const ClothLift::Options& options, const std::string& name, double height,
                 const Positions& x);
};

}  // namespace pliant
