#include "pliant/solvers/contact_response.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.h"

namespace pliant::contact_response_test {
namespace {

constexpr double kCompliance = 2e-5;  // [m/N]

ContactRow random_row(Random& random) {
  ContactRow row;
  row.normal = random.vector(1.0).normalized();
  row.gap = random(-1e-4, 1e-4);
  const auto across = [&](double size) {
    const Eigen::Vector3d v = random.vector(size);
    return Eigen::Vector3d(v - row.normal * row.normal.dot(v));
  };
  row.slip = across(1e-4);
  row.friction = random(0.0, 1.5);
  row.adhesion = random(0.0, 2.0);
  row.normal_force = random(0.0, 5.0);
  row.friction_force = across(2.0);
  return row;
}

TEST(ContactResponse, HoldsSignorinisAndCoulombsLaws) {
  Random random(1);
  int open = 0, stuck = 0, slid = 0;
  for (int k = 0; k < 1000; ++k) {
    const ContactRow row = random_row(random);
    const ContactResponse response(row, kCompliance, random.vector(1e-4));
    EXPECT_GE(response.normal_force, -row.adhesion);
    EXPECT_NEAR(row.normal.dot(response.friction_force), 0.0, 1e-12);
    const double bound = row.friction_bound(response.normal_force);
    const double rubs = response.friction_force.norm();
    EXPECT_LE(rubs, bound * (1.0 + 1e-12) + 1e-15);
    open += bound == 0.0;
    stuck += rubs < 0.999 * bound;
    slid += bound > 0.0 && rubs >= 0.999 * bound;
  }
  EXPECT_GT(std::min({open, stuck, slid}), 50) << "each case came up";
}

TEST(ContactResponse, KeepsForcesThatTheLawsHoldAlready) {
  ContactRow row;
  row.normal = Eigen::Vector3d::UnitZ();
  row.friction = 0.5;
  row.normal_force = 4.0;
  row.friction_force = Eigen::Vector3d(1.0, -1.0, 0.0);  // within the cone, no slip: it sticks
  row.slip.setZero();
  ContactResponse response(row, kCompliance, Eigen::Vector3d::Zero());
  EXPECT_LT((response.force(row) - row.force()).norm(), 1e-14);
  // At the cone's edge, against the slip.
  row.friction_force = Eigen::Vector3d(-2.0, 0.0, 0.0);
  row.slip = Eigen::Vector3d(1e-3, 0.0, 0.0);
  response = ContactResponse(row, kCompliance, Eigen::Vector3d::Zero());
  EXPECT_LT((response.force(row) - row.force()).norm(), 1e-14);
}

/// −∂f/∂u by central differences.
template <class ForceAt>
Eigen::Matrix3d differences(const Eigen::Vector3d& u, const ForceAt& force_at) {
  constexpr double kStep = 1e-10;
  Eigen::Matrix3d result;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(c);
    result.col(c) = (force_at(u - d) - force_at(u + d)) / (2.0 * kStep);
  }
  return result;
}

TEST(ContactResponse, ItsStiffnessIsItsDerivative) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const ContactRow row = random_row(random);
    const Eigen::Vector3d u = random.vector(1e-4);
    const double bound = random(0.1, 3.0);
    const auto coulomb = [&](const Eigen::Vector3d& at) {
      return ContactResponse(row, kCompliance, at).force(row);
    };
    const auto tresca = [&](const Eigen::Vector3d& at) {
      return ContactResponse::with_bound(row, kCompliance, at, bound).force(row);
    };
    // Differences lose ten of sixteen digits of forces of a few newtons; and not at a kink.
    const double allowed = 1e-4 / kCompliance;
    EXPECT_LT((ContactResponse(row, kCompliance, u).stiffness(row, true) - differences(u, coulomb))
                  .norm(),
              allowed)
        << k;
    EXPECT_LT((ContactResponse::with_bound(row, kCompliance, u, bound).stiffness(row, false) -
               differences(u, tresca))
                  .norm(),
              allowed)
        << k;
  }
}

TEST(ContactResponse, WithGivenDisksItIsTheGradientOfAConvexPotential) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const ContactRow row = random_row(random);
    const double bound = random(0.0, 3.0);
    const auto at = [&](const Eigen::Vector3d& u) {
      return ContactResponse::with_bound(row, kCompliance, u, bound);
    };
    const Eigen::Vector3d a = random.vector(2e-4), b = random.vector(2e-4);
    constexpr double kStep = 1e-8;
    const Eigen::Vector3d d = random.vector(1.0);
    const double slope =
        (at(a + kStep * d).potential(row) - at(a - kStep * d).potential(row)) / (2.0 * kStep);
    EXPECT_NEAR(slope, -d.dot(at(a).force(row)), 1e-5 + kStep / kCompliance);
    const double middle = at(0.5 * (a + b)).potential(row);
    EXPECT_LE(middle, 0.5 * (at(a).potential(row) + at(b).potential(row)) + 1e-15);
  }
}

}  // namespace
}  // namespace pliant::contact_response_test
