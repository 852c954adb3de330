#include "pliant/models/reduced/stvk_body.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/models/reduced/linear_modes.h"
#include "support/expect_refusal.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {
namespace {

/// Central differences of a quartic polynomial at h and 2h, without an error of truncation.
template <class Function>
auto slope(const Function& f, double h) {
  const decltype(f(h)) narrow = (f(h) - f(-h)) / (2.0 * h);
  const decltype(f(h)) wide = (f(2.0 * h) - f(-2.0 * h)) / (4.0 * h);
  return decltype(f(h))((4.0 * narrow - wide) / 3.0);
}

/// Strains of tetrahedra, and averaged ones.
class StvkStrains : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Both, StvkStrains, testing::Bool(),
                         [](const auto& info) { return info.param ? "averaged" : "tetrahedra"; });

TEST_P(StvkStrains, ForcesAreTheEnergysGradient) {
  const StvkBody body = small_cantilever(GetParam());
  const Eigen::VectorXd u = random_vector(body.size(), 0.1, 1);
  const Eigen::VectorXd d = random_vector(body.size(), 0.1, 2);
  const double expected = slope([&](double t) { return body.energy(u + t * d); }, 0.5);
  EXPECT_NEAR(body.forces(u).dot(d), expected, 1e-11 * std::abs(expected));
}

TEST_P(StvkStrains, StiffnessAndSecondDerivativeAreTheForcesDerivatives) {
  const StvkBody body = small_cantilever(GetParam());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.size());
  const Eigen::VectorXd a = random_vector(body.size(), 0.1, 3);
  const Eigen::VectorXd b = random_vector(body.size(), 0.1, 4);
  const Eigen::VectorXd first =
      slope([&](double t) { return Eigen::VectorXd(body.forces(zero + t * a)); }, 0.5);
  EXPECT_LT((body.rest_stiffness() * a - first).norm(), 1e-12 * first.norm());
  // ½ (R(u) + R(-u)) is the quadratic part; polarised it is the mixed derivative.
  const auto quadratic = [&](const Eigen::VectorXd& u) -> Eigen::VectorXd {
    return body.forces(u) + body.forces(-u);
  };
  const Eigen::VectorXd mixed = 0.5 * (quadratic(a + b) - quadratic(a) - quadratic(b));
  EXPECT_LT((body.second_derivative(a, b) - mixed).norm(), 1e-12 * mixed.norm());
  EXPECT_EQ(body.second_derivative(a, b), body.second_derivative(b, a));
}

TEST_P(StvkStrains, RotationsCostNoEnergy) {
  const StvkBody body(make_block({{1.0, 0.5, 0.7}, {1, 2, 1}}), {1e6, 0.4, 500.0}, {}, "block",
                      GetParam());
  const Eigen::Matrix3Xd& x = body.mesh().vertices;
  Random random(5);
  const Eigen::Matrix3Xd moved = (random.rotation() * x).colwise() + random.vector(3.0);
  const Eigen::Matrix3Xd u = moved - x;
  const Eigen::Map<const Eigen::VectorXd> flat(u.data(), u.size());
  EXPECT_LT(body.energy(flat), 1e-20 * 1e6);
  EXPECT_LT(body.forces(flat).norm(), 1e-9);
}

TEST(StvkBody, AveragedStrainsSwingAsABeamNearPoissonsRatioAHalf) {
  const BlockOptions block{{1.0, 0.1, 0.1}, {40, 4, 4}};
  const ElasticMaterial material{1e6, 0.49, 1000.0};
  const auto frequency = [&](bool averaged) {
    const StvkBody body = cantilever(block, material, averaged);
    return std::sqrt(
        linear_modes(body, body.rest_stiffness(), body.consistent_mass(), 1).lambda[0]);
  };
  // Euler and Bernoulli: 3.516 √(E I/(ρ A))/L²
  const double beam = 3.51602 * std::sqrt(1e6 * 0.01 / 12.0 / 1000.0);
  EXPECT_NEAR(frequency(true) / beam, 1.0, 0.03);
  EXPECT_GE(frequency(false) / beam, 1.05) << "the twin that it is there to better";
}

TEST(StvkBody, MassesSumToTheBodys) {
  const StvkBody body(make_block({{1.0, 0.5, 0.7}, {2, 2, 1}}), {1e6, 0.4, 500.0}, {}, "block");
  Eigen::VectorXd along_x = Eigen::VectorXd::Zero(body.size());
  for (int i = 0; i < body.size(); i += 3) along_x[i] = 1.0;
  const double mass = 500.0 * 0.35;
  EXPECT_NEAR(along_x.dot(body.consistent_mass() * along_x), mass, 1e-12 * mass);
  EXPECT_NEAR(along_x.dot(body.lumped_mass() * along_x), mass, 1e-12 * mass);
  // A linear field's kinetic energy is exact with the consistent mass: ∫ ρ x² = ρ A L³/12.
  Eigen::VectorXd linear = Eigen::VectorXd::Zero(body.size());
  for (int v = 0; 3 * v < body.size(); ++v) linear[3 * v] = body.mesh().vertices(0, v);
  EXPECT_NEAR(linear.dot(body.consistent_mass() * linear), mass / 12.0, 1e-12 * mass);
}

TEST(StvkBody, RefusesWhatItCannotUse) {
  const TetrahedralMesh mesh = make_block({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [&](const ElasticMaterial& material, const std::vector<int>& fixed) {
    StvkBody(mesh, material, fixed, "body");
  };
  expect_refusal([&] { make({0.0, 0.3, 1.0}, {}); }, {"body", "young", "positive"});
  expect_refusal([&] { make({nan, 0.3, 1.0}, {}); }, {"young"});
  expect_refusal([&] { make({1.0, 0.5, 1.0}, {}); }, {"poisson", "(-1, 0.5)"});
  expect_refusal([&] { make({1.0, 0.3, -1.0}, {}); }, {"density", "positive"});
  expect_refusal(
      [&] {
        StvkBody(mesh, {1.0, -0.1, 1.0}, {}, "body", true);
      },
      {"poisson is -0.1", "averaged"});
  expect_refusal([&] { make({}, {8}); }, {"fixed vertex 8", "[0, 8)"});
  expect_refusal([&] { make({}, {0, 1, 2, 3, 4, 5, 6, 7}); }, {"every vertex is fixed"});
}

}  // namespace
}  // namespace pliant
