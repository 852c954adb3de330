#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "pliant/effects/self_contact/sheet_tree_search.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/random.h"

/// Sheets that come near themselves, and searches of them to compare.
namespace pliant {

/// What a search is asked for in one step.
struct SheetMotion {
  Positions start, end;
};

/// A sheet at rest, and how it moves in some steps.
struct MovingSheet {
  TriangleMesh rest;
  std::vector<SheetMotion> steps;
  double thickness = 0.004, margin = 0.001;  // [m]
};

/// Folded over in the middle, `gap` above itself, one half slides along and sinks into the other.
inline MovingSheet folded_sheet(int side, double gap, double speed = 0.4, int steps = 6) {
  constexpr double kStep = 0.005;  // [s]
  MovingSheet sheet;
  sheet.rest = make_grid({0.3, 0.3, side, side});
  Positions x = sheet.rest.vertices;
  for (auto place : x.colwise()) {
    if (place.x() > 0.0) place << -place.x() + 0.002, place.y() + 0.0013, gap;
  }
  for (int s = 0; s < steps; ++s) {
    Positions end = x;
    for (int i = 0; i < x.cols(); ++i) {
      if (sheet.rest.vertices(0, i) > 0.0) {
        end.col(i) += kStep * speed * Eigen::Vector3d(0.4, 0.2, -1.0);
      }
    }
    sheet.steps.push_back({x, end});
    x = end;
  }
  return sheet;
}

/// Rolled to a ball of no order, each vertex on a path of its own; every third step jumps.
inline MovingSheet crumpled_sheet(int side, std::uint64_t seed, int steps = 5) {
  Random random(seed);
  MovingSheet sheet;
  sheet.rest = make_grid({0.3, 0.3, side, side});
  Positions x = sheet.rest.vertices;
  for (auto place : x.colwise()) {
    const double a = 40.0 * place.x(), b = 31.0 * place.y();
    place = Eigen::Vector3d(0.02 * std::sin(a) + 0.01 * std::sin(2.1 * b),
                            0.02 * std::cos(b) + 0.01 * std::cos(1.7 * a),
                            0.02 * std::sin(a + 0.9 * b)) +
            random.vector(0.001);
  }
  for (int s = 0; s < steps; ++s) {
    const double size = s % 3 == 2 ? 0.01 : 0.0007;
    const Eigen::Vector3d all = random.vector(0.01);
    const Positions end = (x + random.positions(static_cast<int>(x.cols()), size)).colwise() + all;
    sheet.steps.push_back({x, end});
    x = end;
  }
  return sheet;
}

/// Rolled up ever more tightly until its layers touch, while it turns, falls and is stretched.
inline MovingSheet rolled_sheet(int side, int steps = 12) {
  MovingSheet sheet;
  sheet.rest = make_grid({0.3, 0.3, side, side});
  const auto at = [&](int step) {
    const double share = static_cast<double>(step) / steps;
    const double tightest = 0.012 + 0.1 * (1.0 - share);  // radius of the innermost layer [m]
    const Eigen::Isometry3d placement =
        Eigen::Translation3d(0.1, -0.2, -share) *
        Eigen::AngleAxisd(2.0 * share, Eigen::Vector3d(1, 2, 3).normalized());
    Positions x = sheet.rest.vertices;
    for (auto place : x.colwise()) {
      // A spiral whose layers come to lie 0.9 of the thickness apart.
      const double along = place.x() + 0.15, turn = along / tightest;
      const double radius = tightest + 0.9 * sheet.thickness * turn / 6.2832;
      place = placement * Eigen::Vector3d(radius * std::cos(turn), (1.0 + 0.1 * share) * place.y(),
                                          radius * std::sin(turn));
    }
    return x;
  };
  for (int s = 0; s < steps; ++s) sheet.steps.push_back({at(s), at(s + 1)});
  return sheet;
}

/// Pressed together along x, with waves across it that grow until it folds.
inline MovingSheet wavy_sheet(int side, int steps = 12) {
  MovingSheet sheet;
  sheet.rest = make_grid({0.3, 0.3, side, side});
  const auto at = [&](int step) {
    const double share = static_cast<double>(step) / steps;
    Positions x = sheet.rest.vertices;
    for (auto place : x.colwise()) {
      const double wave = std::sin(60.0 * place.x() + 5.0 * place.y());
      place = Eigen::Vector3d((1.0 - 0.9 * share) * place.x(), place.y(), 0.04 * share * wave);
    }
    return x;
  };
  for (int s = 0; s < steps; ++s) sheet.steps.push_back({at(s), at(s + 1)});
  return sheet;
}

/// All triangles apart, thrown together at random; some share a place, some have no area.
inline MovingSheet triangle_soup(int triangles, std::uint64_t seed, int steps = 4) {
  Random random(seed);
  MovingSheet sheet;
  sheet.rest.vertices.resize(3, 3 * triangles);
  sheet.rest.triangles.resize(3, triangles);
  for (int t = 0; t < triangles; ++t) {
    const Eigen::Vector3d at = random.vector(0.05);
    for (int k = 0; k < 3; ++k) {
      sheet.rest.vertices.col(3 * t + k) = at + random.vector(0.01);
      sheet.rest.triangles(k, t) = 3 * t + k;
    }
  }
  Positions x = sheet.rest.vertices;
  for (int t = 5; t < triangles; t += 5) x.middleCols(3 * t, 3) = x.middleCols(3 * (t - 5), 3);
  for (int t = 3; t < triangles; t += 7) x.col(3 * t + 1) = x.col(3 * t);
  for (int s = 0; s < steps; ++s) {
    const Positions end = x + random.positions(3 * triangles, s == 0 ? 0.0 : 0.004);
    sheet.steps.push_back({x, end});
    x = end;
  }
  return sheet;
}

/// Two squares of one sheet that lie exactly on each other, and stay.
inline MovingSheet coincident_layers(int side) {
  MovingSheet sheet = folded_sheet(side, 0.0, 0.0, 3);
  for (SheetMotion& step : sheet.steps) {
    for (Positions* x : {&step.start, &step.end}) {
      for (int i = 0; i < x->cols(); ++i) {
        x->col(i) = sheet.rest.vertices.col(i).cwiseProduct(Eigen::Vector3d(1, 1, 0));
        (*x)(0, i) = -std::abs((*x)(0, i));
      }
    }
  }
  return sheet;
}

/// A vertex of a strip goes through a triangle of another at 5 m/s.
inline MovingSheet shot_sheet() {
  MovingSheet sheet = folded_sheet(9, 0.01, 0.0, 1);
  SheetMotion& step = sheet.steps.front();
  for (int i = 0; i < step.end.cols(); ++i) {
    if (sheet.rest.vertices(0, i) > 0.1) step.end(2, i) -= 5.0 * 0.005;
  }
  return sheet;
}

inline SheetTreeSearch search_of(const MovingSheet& sheet) {
  return {sheet.rest.vertices, sheet.rest.triangles, sheet.thickness, sheet.margin};
}

/// To the bit.
inline void expect_same(const SheetNearPairs& found, const SheetNearPairs& exact) {
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const SheetNearPair &a = found[k], &b = exact[k];
    ASSERT_EQ(a.kind, b.kind) << k;
    for (int p = 0; p < 4; ++p) {
      ASSERT_EQ(a.particles[p], b.particles[p]) << k;
      ASSERT_EQ(a.approach.weights.of[p], b.approach.weights.of[p]) << k;
    }
    ASSERT_EQ(a.thickness, b.thickness) << k;
    ASSERT_EQ(a.approach.time, b.approach.time) << k;
    ASSERT_EQ(a.approach.start, b.approach.start) << k;
    const Double3 &v = a.approach.between, &w = b.approach.between;
    ASSERT_TRUE(v.x == w.x && v.y == w.y && v.z == w.z) << k;
  }
}

/// What comparing two searches saw.
struct SheetComparison {
  std::size_t near_pairs = 0;
  int held_back = 0;  ///< steps that could not be taken whole
};

/// Each step is looked for, then gone: both have to find and to allow the same.
inline SheetComparison compare(const MovingSheet& sheet, SheetSearch& search,
                               SheetSearch& reference) {
  SheetComparison all;
  Particles particles(sheet.rest.vertices, Eigen::VectorXd::Ones(sheet.rest.vertices.cols()));
  particles.fix(0);
  for (const SheetMotion& step : sheet.steps) {
    SheetNearPairs exact = reference.find(step.start, step.end);
    SheetNearPairs found = search.find(step.start, step.end);
    expect_same(found, exact);
    all.near_pairs += exact.size();
    // Not quite what was looked for, as iterations leave it; and again the rest of the path.
    Positions x = step.end, y;
    x.row(2).array() -= 0.0005;
    for (int part = 0; part < 3 && !testing::Test::HasFatalFailure(); ++part) {
      y = x;
      const bool is_free = reference.limit_displacement(particles, y, exact);
      Positions z = x;
      EXPECT_EQ(search.limit_displacement(particles, z, found), is_free);
      EXPECT_TRUE(z == y);
      if (is_free) break;
      ++all.held_back;
      expect_same(found, exact);
      all.near_pairs += exact.size();
    }
    if (testing::Test::HasFatalFailure()) break;
  }
  return all;
}

}  // namespace pliant
