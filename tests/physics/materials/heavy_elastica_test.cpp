// A strip of cloth that sags under its own weight, against the heavy elastica.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/models/registry.h"
#include "pliant/study/judges/strip_elastica.h"
#include "support/meshes/sheet_triangulations.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/statics.h"
#include "support/worlds/worlds.h"

namespace pliant::heavy_elastica_test {
namespace {

constexpr double kGravity = 9.81, kDensity = 0.2, kLength = 0.2, kWidth = 0.02;  // SI units

struct Point {
  double along, below;  // [m]
};

/// Tip of an inextensible strip of bending stiffness B that is clamped level.
Point elastica(double bending) {
  const double unit = std::cbrt(bending / (kDensity * kGravity));  // [m]
  const StripTip tip = elastica_tip(kLength / unit);
  return {unit * tip.along, unit * tip.below};
}

enum class Along { kWarp, kWeft, kBias };

/// A strip that lies along x: a grid's with the fabric's warp or weft along it, or triangles with a
/// warp direction of their own.
struct Strip {
  const char* name;
  Along along;
  bool is_grid = false;
  Triangulation mesh = Triangulation::kAlternating;
};

/// Both ends of a strip's first cell are held. The second of them turns by what bends the cell and
/// a half next to the end, so the strip is clamped where a turn there would be as easy, 1 - 1 / 1.5
/// cells further than in the middle of that cell.
constexpr double kClamp = 0.5 + (1.0 - 1.0 / 1.5);  // in cells

GridOptions grid_of(int cells) {
  const double cell = kLength / (cells - kClamp);
  return {cells * cell, kWidth, cells + 1, cells / 5 + 1};
}

std::unique_ptr<Model> cloth_of(const Strip& strip, GridOptions grid,
                                const ParameterText& bending) {
  ParameterText material = bending;
  material["areal_density"] = std::to_string(kDensity);
  material["stretch_warp"] = material["stretch_weft"] = "3000";
  material["shear"] = "300";
  BodyGeometry geometry;
  if (strip.is_grid) {
    if (strip.along == Along::kWeft) {
      std::swap(grid.width, grid.height);
      std::swap(grid.columns, grid.rows);
    }
    geometry = {make_grid(grid), grid};
    material["grid_shear"] = "cells";
  } else {
    geometry.mesh = triangulated(grid, strip.mesh, 2);
    material["mesh_bending"] = "plates";
    if (strip.along == Along::kWeft) material["warp_direction"] = "[0, 1, 0]";
    if (strip.along == Along::kBias) material["warp_direction"] = "[1, 1, 0]";
  }
  const auto& entry = model_registry().find("cloth");
  return entry.make(parse_parameters(entry.parameters, material, "test"), geometry);
}

/// Tip of a strip of so many cells along its length.
Point sagging(const Strip& strip, int cells, const ParameterText& bending) {
  const GridOptions grid = grid_of(cells);
  const double cell = grid.width / cells;
  const auto cloth = cloth_of(strip, grid, bending);
  const auto& system = projective_system(*cloth);
  std::vector<const ElementSet*> sets;
  for (const auto& set : system.elements) sets.push_back(set.get());
  const Particles& particles = cloth->particles();
  Statics statics(sets, particles.size());
  const int axis = strip.is_grid && strip.along == Along::kWeft ? 1 : 0;
  const double start = particles.x.row(axis).minCoeff();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.x(axis, i) < start + 1.01 * cell) statics.fix(i);
  }
  Positions x = particles.x;
  constexpr int kLoads = 10;  // one after the other, each from where the last one left it
  for (int n = 1; n <= kLoads; ++n) {
    statics.load.row(2) = -kGravity * n / kLoads * particles.mass.transpose();
    const double weight = kGravity * particles.mass.sum();
    EXPECT_LE(statics.solve(x), 1e-6 * weight);
  }
  Point tip{0.0, 0.0};
  int count = 0;
  for (int i = 0; i < x.cols(); ++i) {
    if (particles.x(axis, i) < -start - 1e-9) continue;
    tip.along += x(axis, i) - start - kClamp * cell;
    tip.below -= x(2, i);
    ++count;
  }
  return {tip.along / count, tip.below / count};
}

class HeavyElastica : public testing::TestWithParam<Strip> {};

TEST_P(HeavyElastica, IsWhatAStripOfClothSagsLike) {
  const Strip& strip = GetParam();
  for (const double bending : {5e-3, 1e-3}) {
    const std::string own = std::to_string(bending);
    // Along the bias a narrow strip takes the easier of ways to twist: both alike leave it none.
    const std::string other = strip.along == Along::kBias ? own : std::to_string(7.0 * bending);
    const bool along_weft = strip.along == Along::kWeft;
    const ParameterText material = {{"bending_warp", along_weft ? other : own},
                                    {"bending_weft", along_weft ? own : other}};
    const Point theory = elastica(bending);
    double coarse = 0.0, fine = 0.0;
    for (const int cells : {10, 20}) {
      const Point tip = sagging(strip, cells, material);
      const double error = std::hypot(tip.along - theory.along, tip.below - theory.below) / kLength;
      (cells == 10 ? coarse : fine) = error;
    }
    // Of second order, but for threads that give by w L / (2 K), 1e-4, and springs whose rest
    // lengths are chords; of first order at least where vertices lie anyhow, in cells twice as long
    // as wide that are seven times as stiff across as along.
    const bool is_regular = strip.is_grid || strip.mesh != Triangulation::kIrregular;
    EXPECT_LE(fine, is_regular ? 0.005 : 0.012) << bending;
    EXPECT_LE(fine, is_regular ? coarse / 3.0 : std::max(coarse / 2.0, 0.0035)) << bending;
  }
}

constexpr Strip kStrips[] = {
    {"grid_along_warp", Along::kWarp, true},
    {"grid_along_weft", Along::kWeft, true},
    {"alternating", Along::kWarp, false, Triangulation::kAlternating},
    {"one_sided", Along::kWarp, false, Triangulation::kOneSided},
    {"random_diagonals", Along::kWarp, false, Triangulation::kRandomDiagonals},
    {"irregular_along_warp", Along::kWarp, false, Triangulation::kIrregular},
    {"irregular_along_weft", Along::kWeft, false, Triangulation::kIrregular},
    {"irregular_along_the_bias", Along::kBias, false, Triangulation::kIrregular},
};
INSTANTIATE_TEST_SUITE_P(Strips, HeavyElastica, testing::ValuesIn(kStrips),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace pliant::heavy_elastica_test
