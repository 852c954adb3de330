#pragma once

#include <vector>

#include "pliant/core/world.h"
#include "pliant/effects/air/air.h"
#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// The thesis's cloth, 30 cm wide, wet, on a table, which a hand lifts.
class ClothLift {
 public:
  struct Options {
    int side = 50;           ///< vertices along each side
    int points = 1;          ///< at which it is lifted, 1 or 2
    double air = 0.0;        ///< sealed below [m³]
    double time_step = 0.0;  ///< [s]
    std::string solver = "xpbd";
    ParameterText solver_parameters;
    ParameterText material;
    bool self_contact = true;
    double max_stretch = 0.0;  ///< along warp and weft; 0: no limit
  };
  explicit ClothLift(const Options& options);

  /// One step in which the hand rises by `rise` [m]. False where the step failed.
  bool step(double rise);
  World& world() { return world_; }
  Body& body() { return world_.bodies().front(); }
  const AirEffect& air() { return *body().find<AirEffect>(); }
  const GridOptions& grid() const { return grid_; }
  const Positions& rest() const { return rest_; }
  const std::vector<int>& held() const { return held_; }

  static constexpr double kWidth = 0.3;        // [m]
  static constexpr double kApart = 0.1;        // of two points [m]
  static constexpr double kThickness = 0.002;  // [m]

 private:
  World world_;
  GridOptions grid_;
  Positions rest_;
  std::vector<int> held_;
};

}  // namespace pliant
