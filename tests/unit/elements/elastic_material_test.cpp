#include "pliant/elements/solids/elastic_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

TEST(ElasticMaterial, GivesTheLameParameters) {
  const TetrahedronStiffness none = tetrahedron_stiffness({2e5, 0.0, 1000.0});
  EXPECT_DOUBLE_EQ(none.corotated, 1e5);  // Young's modulus is 2 s
  EXPECT_EQ(none.volume, 0.0);
  // λ = E ν / ((1 + ν) (1 - 2 ν)), κ = 3 λ
  const TetrahedronStiffness rubber = tetrahedron_stiffness({1e5, 0.4, 1000.0});
  EXPECT_DOUBLE_EQ(rubber.corotated, 1e5 / 2.8);
  EXPECT_NEAR(rubber.volume, 3.0 * 1e5 * 0.4 / (1.4 * 0.2), 1e-9);
  EXPECT_TRUE(std::isfinite(tetrahedron_stiffness({1e5, 0.499999, 1000.0}).volume));
}

TEST(ElasticMaterial, RefusesWhatItCannotMake) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, inf, std::nan("")}) {
    expect_refusal([&] { tetrahedron_stiffness({bad, 0.3, 1e3}); }, {"Young's modulus", "Pa"});
    expect_refusal([&] { tetrahedron_stiffness({1e5, 0.3, bad}); }, {"density", "kg/m^3"});
  }
  expect_refusal([&] { tetrahedron_stiffness({1e5, -0.1, 1e3}); }, {"-0.1", "thicker", "take 0"});
  for (const double bad : {0.5, 0.7, inf, std::nan("")}) {
    expect_refusal([&] { tetrahedron_stiffness({1e5, bad, 1e3}); }, {"[0, 0.5)", "take 0.45"});
  }
}

}  // namespace
}  // namespace pliant
