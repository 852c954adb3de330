// The search of a sheet's contacts with itself against a look at every pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pliant/effects/self_contact/sheet_mesh.h"
#include "support/solvers/sheet_searches.h"

namespace pliant::sheet_search_test {
namespace {

/// All that comes near in a step, every pair looked at.
class EveryPair {
 public:
  EveryPair(const SheetTreeSearch& search, const SheetMotion& motion)
      : search_(search), mesh_(search.mesh()), joints_(mesh_.joints()) {
    const Eigen::Vector3d mean = (motion.end - motion.start).rowwise().mean();
    start_ = motion.start;
    end_ = motion.end.colwise() - mean;
    for (int v = 0; v < mesh_.vertices(); ++v) {
      for (const auto t : mesh_.triangles.colwise()) {
        if ((t.array() == v).any()) continue;
        look(SimplexPair::kPointTriangle, {v, t[0], t[1], t[2]});
      }
    }
    for (int e = 0; e < mesh_.edges.cols(); ++e) {
      for (int f = e + 1; f < mesh_.edges.cols(); ++f) {
        const auto a = mesh_.edges.col(e), b = mesh_.edges.col(f);
        if ((b.array() == a[0]).any() || (b.array() == a[1]).any()) continue;
        look(SimplexPair::kSegments, {a[0], a[1], b[0], b[1]});
      }
    }
  }
  const std::vector<SheetNearPair>& near() const { return near_; }

 private:
  void look(SimplexPair kind, const std::array<int, 4>& particles) {
    SheetNearPair near;
    near.kind = kind;
    std::copy(particles.begin(), particles.end(), near.particles);
    near.thickness = sheet_pairs::thickness_of(joints_, kind, near.particles, search_.thickness());
    if (!(near.thickness > 0.0)) return;
    const bool is_near = find_approach(kind, sheet_pairs::places(places_in(start_), near.particles),
                                       sheet_pairs::places(places_in(end_), near.particles),
                                       near.thickness + search_.margin(), near.approach);
    if (is_near) near_.push_back(near);
  }

  const SheetTreeSearch& search_;
  const SheetMesh& mesh_;
  SheetJoints joints_;
  Positions start_, end_;
  std::vector<SheetNearPair> near_;
};

bool is_same_pair(const SheetNearPair& a, const SheetNearPair& b) {
  return a.kind == b.kind && std::equal(a.particles, a.particles + 4, b.particles);
}

/// Whether `found` has a pair, or of a vertex one with the same nearest point, which two triangles
/// share.
bool has(const SheetNearPairs& found, const SheetNearPair& pair) {
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (is_same_pair(found[k], pair)) return true;
    const bool is_shared =
        pair.is_vertex() && found[k].is_vertex() && found[k].particles[0] == pair.particles[0] &&
        norm(found[k].approach.between - pair.approach.between) <= 1e-6 * pair.thickness;
    if (is_shared) return true;
  }
  return false;
}

/// Returns how many pairs were near in all steps.
std::size_t compare_with_every_pair(const MovingSheet& sheet) {
  SheetTreeSearch search = search_of(sheet);
  std::size_t count = 0;
  for (const SheetMotion& step : sheet.steps) {
    const EveryPair all(search, step);
    const SheetNearPairs found = search.find(step.start, step.end);
    for (const SheetNearPair& pair : all.near()) {
      // Edges that are nearest at an end have contacts of that vertex.
      if (!pair.is_vertex() && !sheet_pairs::is_within(pair.approach.weights)) continue;
      EXPECT_TRUE(has(found, pair)) << "missed at a distance of " << norm(pair.approach.between);
      if (testing::Test::HasFailure()) return count;
    }
    for (std::size_t k = 0; k < found.size(); ++k) {
      const bool is_there =
          std::any_of(all.near().begin(), all.near().end(),
                      [&](const SheetNearPair& pair) { return is_same_pair(pair, found[k]); });
      EXPECT_TRUE(is_there) << "found at a distance of " << norm(found[k].approach.between);
    }
    count += all.near().size();
  }
  return count;
}

TEST(SheetSearch, FindsEveryPairOfASheetThatIsRolledUp) {
  EXPECT_GT(compare_with_every_pair(rolled_sheet(21)), 1000u);
}

TEST(SheetSearch, FindsEveryPairOfWavesThatFold) {
  EXPECT_GT(compare_with_every_pair(wavy_sheet(21)), 1000u);
}

TEST(SheetSearch, FindsEveryPairOfAFold) {
  EXPECT_GT(compare_with_every_pair(folded_sheet(17, 0.006)), 1000u);
}

TEST(SheetSearch, FindsEveryPairOfACrumpledSheet) {
  EXPECT_GT(compare_with_every_pair(crumpled_sheet(12, 5)), 1000u);
}

TEST(SheetSearch, FindsEveryPairOfTrianglesInNoOrder) {
  EXPECT_GT(compare_with_every_pair(triangle_soup(60, 3)), 300u);
}

TEST(SheetSearch, FindsEveryPairOfASheetThatIsNoPlaneAtRest) {
  // At rest it is rolled up; it is laid flat and rolled up the other way.
  MovingSheet sheet = rolled_sheet(21);
  sheet.rest.vertices = sheet.steps.back().end;
  std::reverse(sheet.steps.begin(), sheet.steps.end());
  for (SheetMotion& step : sheet.steps) std::swap(step.start, step.end);
  EXPECT_GT(compare_with_every_pair(sheet), 1000u);
}

TEST(SheetSearch, ASmoothSheetMeetsNothing) {
  const MovingSheet sheet = rolled_sheet(21, 60);
  SheetTreeSearch search = search_of(sheet);
  for (int s = 0; s < 20; ++s) {
    const SheetMotion& step = sheet.steps[static_cast<std::size_t>(s)];
    EXPECT_TRUE(search.find(step.start, step.end).empty()) << s;
  }
}

// A vertex and an edge across it are joined, and the least that such have between them at rest is
// the height of a right triangle with two sides of 10 cm. They keep half of that.
TEST(SheetMesh, WhatIsJoinedKeepsHalfOfWhatItHasAtRest) {
  const TriangleMesh grid = make_grid({0.3, 0.3, 4, 4});
  const SheetMesh mesh(grid.vertices, grid.triangles);
  EXPECT_NEAR(least_thickness(mesh, 1.0), 0.5 * 0.1 / std::sqrt(2.0), 1e-15);
  EXPECT_EQ(least_thickness(mesh, 0.03), 0.03);
}

// A small triangle falls from 10 cm to 10 cm below a large one.
TEST(SheetSearch, WhatWouldPassGoesMostOfThePathToWhereItTouches) {
  Positions start(3, 6);
  start << -1.0, 1.0, 0.0, -0.1, 0.1, 0.0,  //
      -1.0, -1.0, 1.0, -0.1, -0.1, 0.1,     //
      0.0, 0.0, 0.0, 0.1, 0.1, 0.1;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 3, 1, 4, 2, 5;
  SheetTreeSearch search(start, triangles, 0.004, 0.001);
  Particles particles(start, Eigen::VectorXd::Ones(6));
  for (int i = 0; i < 3; ++i) particles.fix(i);
  Positions x = start;
  x.block<1, 3>(2, 3).setConstant(-0.1);
  SheetNearPairs found = search.find(start, x);
  EXPECT_FALSE(search.limit_displacement(particles, x, found));
  EXPECT_EQ(x.leftCols(3), start.leftCols(3));
  for (int i = 3; i < 6; ++i) {
    EXPECT_GT(x(2, i), 0.0);
    EXPECT_LT(x(2, i), 0.05);
  }
}

}  // namespace
}  // namespace pliant::sheet_search_test
