#include "pliant/elements/cloth/bending_sums.h"

#include <gtest/gtest.h>

#include <random>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/cloth/bending_hinges.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/meshes/sheet_triangulations.h"

namespace pliant::bending_sums_test {
namespace {

/// 1/2 Σ |κ|², number by number.
double energy_of(const BendingStencils& s, const Positions& x) {
  double energy = 0.0;
  for (int e = 0; e < s.size(); ++e) {
    double squared = 0.0;
    for (int r = 0; r < s.rows; ++r) {
      double curvature[3] = {};
      const int first = s.firsts[static_cast<std::size_t>(e)];
      for (int k = first + 1; k < s.firsts[static_cast<std::size_t>(e) + 1]; ++k) {
        const int own = s.vertices[static_cast<std::size_t>(k)];
        const int origin = s.vertices[static_cast<std::size_t>(first)];
        const double w = s.weights[static_cast<std::size_t>(s.rows * k + r)];
        for (int c = 0; c < 3; ++c) curvature[c] += w * (x(c, own) - x(c, origin));
      }
      squared +=
          curvature[0] * curvature[0] + curvature[1] * curvature[1] + curvature[2] * curvature[2];
    }
    energy += 0.5 * squared;
  }
  return energy;
}

Positions somewhere(int particles) {
  std::mt19937 random(7);
  Positions x(3, particles);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int i = 0; i < particles; ++i) {
    for (int c = 0; c < 3; ++c) x(c, i) = number(random);
  }
  return x;
}

TEST(BendingSums, EnergyHasTheBitsOfItsNumbersOneByOne) {
  const TriangleMesh mesh = triangulated({1.0, 0.5, 7, 5}, kTriangulations[0]);
  const Positions x = somewhere(static_cast<int>(mesh.vertices.cols()));
  const BendingStiffness stiffness{2.0, 0.5};
  for (const BendingStencils& stencils :
       {bending_of(hinges_of_mesh(mesh, {1.0, 0.0, 0.0}, stiffness)),
        bending_of_mesh(mesh, {1.0, 0.0, 0.0}, stiffness)}) {
    const double energy = bending_energy(stencils, x.data(), 0, stencils.size());
    EXPECT_GT(energy, 0.0);
    EXPECT_EQ(energy, energy_of(stencils, x)) << stencils.rows;
    EXPECT_EQ(bending_energy(stencils, x.data(), 1, 1), 0.0);
  }
}

TEST(BendingSums, ForcesHaveTheBitsOfTheirNumbersOneByOneAndAreAdded) {
  BendingRows rows;
  rows.begins = {0, 2, 2, 5};
  rows.columns = {1, 2, 0, 1, 0};
  rows.values = {0.3, -0.7, 1.1, 0.9, -0.2};
  const Positions x = somewhere(3);
  const Forces before = somewhere(3);
  Forces f = before;
  add_bending_forces(rows, x.data(), 0, 3, f.data());
  for (int c = 0; c < 3; ++c) {
    double first = 0.0, last = 0.0;
    for (int k = 0; k < 5; ++k) {
      const int own = k < 2 ? 0 : 2;
      double& sum = k < 2 ? first : last;
      sum += rows.values[static_cast<std::size_t>(k)] *
             (x(c, rows.columns[static_cast<std::size_t>(k)]) - x(c, own));
    }
    EXPECT_EQ(f(c, 0), before(c, 0) + first);
    EXPECT_EQ(f(c, 1), before(c, 1));
    EXPECT_EQ(f(c, 2), before(c, 2) + last);
  }
}

}  // namespace
}  // namespace pliant::bending_sums_test
