// A strip of cloth that sags under its own weight, against the heavy elastica.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/models/registry.h"
#include "pliant/study/judges/strip_elastica.h"
#include "support/projective_model.h"
#include "support/statics.h"
#include "support/worlds.h"

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

/// Tip of a strip of `cells` along its length, which lies along warp (x) or weft (y). The vertices
/// at both ends of the first cell are held: the second of them bends half a cell to either side, so
/// that the strip is clamped in the middle of the first cell.
Point sagging(int cells, bool along_warp, const ParameterText& bending) {
  const double cell = kLength / (cells - 0.5);
  GridOptions grid{cells * cell, kWidth, cells + 1, 3};
  if (!along_warp) {
    std::swap(grid.width, grid.height);
    std::swap(grid.columns, grid.rows);
  }
  ParameterText material = bending;
  material["areal_density"] = std::to_string(kDensity);
  material["stretch_warp"] = material["stretch_weft"] = "3000";
  material["shear"] = "300";
  const auto& entry = model_registry().find("cloth");
  const auto cloth =
      entry.make(parse_parameters(entry.parameters, material, "test"), {make_grid(grid), grid});
  const auto& system = projective_system(*cloth);
  std::vector<const ElementSet*> sets;
  for (const auto& set : system.elements) sets.push_back(set.get());
  const Particles& particles = cloth->particles();
  Statics statics(sets, particles.size());
  const int axis = along_warp ? 0 : 1;
  const double start = particles.x.row(axis).minCoeff();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.x(axis, i) < start + 1.5 * cell) statics.fix(i);
  }
  Positions x = particles.x;
  constexpr int kLoads = 20;  // one after the other, each from where the last one left it
  for (int n = 1; n <= kLoads; ++n) {
    statics.load.row(2) = -kGravity * n / kLoads * particles.mass.transpose();
    const double weight = kGravity * particles.mass.sum();
    EXPECT_LE(statics.solve(x), 1e-6 * weight);
  }
  Point tip{0.0, 0.0};
  int count = 0;
  for (int i = 0; i < x.cols(); ++i) {
    if (particles.x(axis, i) < -start - 1e-9) continue;
    tip.along += x(axis, i) - start - 0.5 * cell;
    tip.below -= x(2, i);
    ++count;
  }
  return {tip.along / count, tip.below / count};
}

class HeavyElastica : public testing::TestWithParam<bool> {};

TEST_P(HeavyElastica, IsWhatAStripOfClothSagsLike) {
  const bool along_warp = GetParam();
  for (const double bending : {5e-3, 1e-3}) {
    const std::string own = std::to_string(bending), other = std::to_string(7.0 * bending);
    const ParameterText material = {{"bending_warp", along_warp ? own : other},
                                    {"bending_weft", along_warp ? other : own}};
    const Point theory = elastica(bending);
    double coarse = 0.0, fine = 0.0;
    for (const int cells : {10, 20}) {
      const Point tip = sagging(cells, along_warp, material);
      const double error = std::hypot(tip.along - theory.along, tip.below - theory.below) / kLength;
      (cells == 10 ? coarse : fine) = error;
    }
    // Of second order, but for threads that give by w L / (2 K), 1e-4, and springs whose rest
    // lengths are chords.
    EXPECT_LE(fine, 0.005) << bending;
    EXPECT_LE(fine, coarse / 3.0) << bending;
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, HeavyElastica, testing::Bool(),
                         [](const auto& info) { return info.param ? "warp" : "weft"; });

}  // namespace
}  // namespace pliant::heavy_elastica_test
