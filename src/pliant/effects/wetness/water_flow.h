#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Water that moves within a sheet, as its vertices' saturation w in [0, 1]. Along an edge of
/// length l flow, per area that the sheet holds when it is full,
///   q = D (wᵢ − wⱼ) b/l + K w³ s b,
/// by capillarity, as diffusion, and down the slope s of the edge, with w of its upper end (the
/// relative permeability of a film or of pores grows with the third power of the saturation: Irmay
/// 1954); b is the width of the Voronoi cells' common side. No vertex takes more than it holds.
class WaterFlow {
 public:
  struct Rates {
    double diffusion = 0.0;  ///< D [m²/s]
    double drainage = 0.0;   ///< K, where it is full and hangs [m/s]
    bool moves() const { return diffusion > 0.0 || drainage > 0.0; }
  };
  /// `rest` 3 x n [m], all of `triangles`' vertices; `areas` of these [m²].
  WaterFlow(const Positions& rest, const Eigen::Matrix3Xi& triangles, const Eigen::VectorXd& areas,
            const Rates& rates);

  /// Moves water for `dt` [s]; `up` is a unit vector. Returns what dripped off, as full area [m²].
  double flow(const Positions& x, const Eigen::Vector3d& up, double dt, Eigen::VectorXd& wetness);

 private:
  struct Edge {
    int a, b;
    double width;   // of the cells' common side, at rest [m]
    double length;  // at rest [m]
  };
  /// Largest step in which nothing swings [s].
  double stable_step() const;
  void find_fluxes(const Positions& x, const Eigen::Vector3d& up, const Eigen::VectorXd& wetness);
  double step(double dt, Eigen::VectorXd& wetness);

  Eigen::VectorXd areas_;
  Rates rates_;
  std::vector<Edge> edges_;
  double largest_step_;
  // Reused. [m²/s]
  Eigen::VectorXd flux_, drip_, in_, out_;
};

}  // namespace pliant
