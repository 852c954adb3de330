#include "pliant/models/reduced/quartic_potential.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/models/reduced/project_potential.h"
#include "support/expect_refusal.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {
namespace {

/// A basis of `rank` random motions.
ReducedBasis random_basis(const StvkBody& body, int rank) {
  Eigen::MatrixXd columns(body.size(), rank);
  for (int c = 0; c < rank; ++c) {
    columns.col(c) = random_vector(body.size(), 1.0, static_cast<std::uint64_t>(10 + c));
  }
  return diagonalise(columns, body.rest_stiffness(), body.consistent_mass());
}

/// Reduced coordinates of displacements of the size of the body.
Eigen::VectorXd large_coordinates(const ReducedBasis& basis, std::uint64_t seed) {
  Eigen::VectorXd q = random_vector(static_cast<int>(basis.u.cols()), 1.0, seed);
  return q * (0.3 / (basis.u * q).cwiseAbs().maxCoeff());
}

TEST(QuarticPotential, IsTheBodysOwnEnergyAndForceInItsSubspace) {
  for (const auto& [rank, averaged] :
       {std::pair(1, false), {2, false}, {7, false}, {20, false}, {7, true}}) {
    const StvkBody body = cantilever({{0.4, 0.2, 0.3}, {4, 2, 3}}, {1e5, 0.35, 1000.0}, averaged);
    const ReducedBasis basis = random_basis(body, rank);
    const QuarticPotential potential = *project_potential(body, basis, go_on);
    QuarticPotential::Workspace workspace;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Eigen::VectorXd q = large_coordinates(basis, seed), u = basis.u * q;
      Eigen::VectorXd r;
      const double v = potential.evaluate(q, r, workspace);
      const Eigen::VectorXd expected = basis.u.transpose() * body.forces(u);
      EXPECT_LT((r - expected).norm(), 1e-10 * expected.norm()) << "rank " << rank;
      EXPECT_NEAR(v, body.energy(u), 1e-10 * body.energy(u)) << "rank " << rank;
    }
  }
}

TEST(QuarticPotential, WithABasisOfAllMotionsIsTheFullBody) {
  const StvkBody body = small_cantilever();
  const ReducedBasis basis = random_basis(body, body.size());
  const QuarticPotential potential = *project_potential(body, basis, go_on);
  QuarticPotential::Workspace workspace;
  const Eigen::VectorXd u = random_vector(body.size(), 0.1, 3);
  const Eigen::MatrixXd mass = body.consistent_mass();
  const Eigen::VectorXd q = basis.u.transpose() * mass * u;
  EXPECT_LT((basis.u * q - u).norm(), 1e-12 * u.norm());
  Eigen::VectorXd r;
  potential.evaluate(q, r, workspace);
  const Eigen::VectorXd forces = mass * (basis.u * r);  // U⁻ᵀ = M U
  EXPECT_LT((forces - body.forces(u)).norm(), 1e-10 * forces.norm());
}

TEST(QuarticPotential, ForceAndTangentAreDerivatives) {
  const StvkBody body = cantilever({{0.4, 0.2, 0.3}, {4, 2, 3}}, {1e5, 0.35, 1000.0});
  const ReducedBasis basis = random_basis(body, 13);
  const QuarticPotential potential = *project_potential(body, basis, go_on);
  QuarticPotential::Workspace workspace;
  const Eigen::VectorXd q = large_coordinates(basis, 1), d = large_coordinates(basis, 2);
  Eigen::VectorXd r, r_with_tangent;
  Eigen::MatrixXd k;
  const double v = potential.evaluate(q, r, workspace);
  EXPECT_NEAR(potential.evaluate(q, r_with_tangent, k, workspace), v, 1e-13 * v);
  EXPECT_LT((r - r_with_tangent).norm(), 1e-13 * r.norm());
  EXPECT_LT((k - k.transpose()).norm(), 1e-14 * k.norm());
  // Five-point differences are exact for quartics and cubics.
  const auto slope = [](const auto& f) {
    return decltype(f(0.5))((8.0 * (f(0.5) - f(-0.5)) - (f(1.0) - f(-1.0))) / 6.0);
  };
  const double dv = slope([&](double t) { return potential.energy(q + t * d, workspace); });
  EXPECT_NEAR(r.dot(d), dv, 1e-11 * std::abs(dv));
  const auto force = [&](double t) {
    Eigen::VectorXd f;
    potential.evaluate(q + t * d, f, workspace);
    return f;
  };
  const Eigen::VectorXd dr = slope(force);
  EXPECT_LT((k * d - dr).norm(), 1e-11 * dr.norm());
}

TEST(QuarticPotential, KeepsItsCoefficientsAndTheirOrder) {
  // V = ½ q₀² + ½ q₁² + a q₀² q₁ + c q₀ q₁³ by hand.
  const double a = 0.7, c = -0.3;
  std::vector<double> coefficients(
      static_cast<std::size_t>(QuarticPotential::coefficient_count(2)));
  ASSERT_EQ(coefficients.size(), 9u);
  coefficients[static_cast<std::size_t>(QuarticPotential::index(2, 0, 0, 1))] = a;
  coefficients[static_cast<std::size_t>(QuarticPotential::index(2, 0, 1, 1, 1))] = c;
  const QuarticPotential potential(Eigen::Vector2d(1.0, 1.0), coefficients, "potential");
  EXPECT_EQ(potential.coefficients(), coefficients);
  QuarticPotential::Workspace workspace;
  const Eigen::VectorXd q = Eigen::Vector2d(0.5, -2.0);
  Eigen::VectorXd r;
  Eigen::MatrixXd k;
  EXPECT_DOUBLE_EQ(potential.evaluate(q, r, k, workspace),
                   0.125 + 2.0 + a * 0.25 * -2.0 + c * 0.5 * -8.0);
  EXPECT_DOUBLE_EQ(r[0], 0.5 + 2.0 * a * 0.5 * -2.0 + c * -8.0);
  EXPECT_DOUBLE_EQ(r[1], -2.0 + a * 0.25 + 3.0 * c * 0.5 * 4.0);
  EXPECT_DOUBLE_EQ(k(0, 0), 1.0 + 2.0 * a * -2.0);
  EXPECT_DOUBLE_EQ(k(0, 1), 2.0 * a * 0.5 + 3.0 * c * 4.0);
  EXPECT_DOUBLE_EQ(k(1, 1), 1.0 + 6.0 * c * 0.5 * -2.0);
}

TEST(QuarticPotential, EveryCoefficientHasAPlaceOfItsOwn) {
  for (int rank : {1, 2, 5}) {
    std::vector<int> uses(static_cast<std::size_t>(QuarticPotential::coefficient_count(rank)));
    for (int k = 0; k < rank; ++k) {
      for (int j = 0; j <= k; ++j) {
        for (int i = 0; i <= j; ++i) {
          ++uses.at(static_cast<std::size_t>(QuarticPotential::index(rank, i, j, k)));
          for (int l = k; l < rank; ++l) {
            ++uses.at(static_cast<std::size_t>(QuarticPotential::index(rank, i, j, k, l)));
          }
        }
      }
    }
    EXPECT_EQ(uses, std::vector<int>(uses.size(), 1)) << "rank " << rank;
  }
}

TEST(QuarticPotential, RefusesWhatIsNoPotential) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const Eigen::VectorXd& lambda, const std::vector<double>& coefficients) {
    QuarticPotential(lambda, coefficients, "file");
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  expect_refusal([&] { make(Eigen::VectorXd(), {}); }, {"file", "rank is 0", "from 1 to 100"});
  expect_refusal([&] { make(-one, {0, 0}); }, {"squared frequency 0 is -1"});
  expect_refusal([&] { make(one, {0, 0, 0}); }, {"3 coefficients", "rank 1 has 2"});
  expect_refusal([&] { make(one, {0, nan}); }, {"coefficient 1 is not finite"});
}

}  // namespace
}  // namespace pliant
