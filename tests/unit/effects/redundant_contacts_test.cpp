#include "pliant/effects/contact/redundant_contacts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace pliant {
namespace {

constexpr double kTolerance = 1e-6;  // [m]

using Points = std::vector<Eigen::Vector3d>;

Points grid(int count) {
  Points points;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) points.emplace_back(0.01 * i, 0.01 * j, 0.0);
  }
  return points;
}

Points ring(int count) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * M_PI * i / count;
    points.emplace_back(0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.0);
  }
  points.emplace_back(0.0, 0.0, 0.0);
  return points;
}

/// What is kept of points that touch the plane z = 0, with their heights as gaps, all turned by
/// `turn`.
std::vector<int> kept(const Points& points,
                      const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  RedundantContacts contacts(kTolerance);
  for (const Eigen::Vector3d& point : points) {
    contacts.add({0, turn * Eigen::Vector3d::UnitZ(), turn * point, point.z()});
  }
  const std::vector<char> redundant = contacts.find();
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (!redundant[static_cast<std::size_t>(i)]) kept.push_back(i);
  }
  return kept;
}

TEST(RedundantContacts, LeavesTheCornersOfAFlatFace) {
  EXPECT_EQ(kept(grid(5)), (std::vector<int>{0, 4, 20, 24}));
}

TEST(RedundantContacts, LeavesTheSameCornersHoweverAllIsTurned) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized();
    EXPECT_EQ(kept(grid(5), turn), (std::vector<int>{0, 4, 20, 24}));
  }
}

TEST(RedundantContacts, LeavesTheRimOfARoundFace) { EXPECT_EQ(kept(ring(24)).size(), 24u); }

TEST(RedundantContacts, LeavesTheEndsOfALine) {
  Points line;
  for (int i = 0; i < 7; ++i) line.emplace_back(0.01 * i, 0.02 * i, 0.001 * i);
  EXPECT_EQ(kept(line), (std::vector<int>{0, 6}));
}

TEST(RedundantContacts, LeavesWhatIsNearerThanTheCornersOfAFace) {
  Points points = grid(3);
  points[4].z() = -1e-4;
  EXPECT_EQ(kept(points), (std::vector<int>{0, 2, 4, 6, 8}));
}

TEST(RedundantContacts, LeavesOutWhatIsFartherThanTheCornersOfAFace) {
  Points points = grid(3);
  points[4].z() = 1e-4;
  EXPECT_EQ(kept(points), (std::vector<int>{0, 2, 6, 8}));
}

TEST(RedundantContacts, LeavesAllWhereTheCornersAreInNoPlane) {
  Points points = grid(3);
  points[0].z() = 1e-4;
  EXPECT_EQ(kept(points).size(), points.size());
}

TEST(RedundantContacts, TellsPlanesAndPairsApart) {
  RedundantContacts contacts(kTolerance);
  for (const Eigen::Vector3d& point : grid(3)) {
    contacts.add({0, Eigen::Vector3d::UnitZ(), point, 0.0});
    contacts.add({1, Eigen::Vector3d::UnitZ(), point, 0.0});
    contacts.add({0, Eigen::Vector3d(1e-3, 0.0, 1.0).normalized(), point, 0.0});
  }
  const std::vector<char> redundant = contacts.find();
  EXPECT_EQ(std::count(redundant.begin(), redundant.end(), 0), 12);
}

/// A body that keeps its shape turns the gaps of its points into others by a linear function.
TEST(RedundantContacts, WhatIsKeptKeepsTheRestOpenHoweverTheBodyTurns) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < 300; ++k) {
    Points points = k % 3 == 0 ? grid(2 + k % 5) : k % 3 == 1 ? ring(5 + k % 40) : Points();
    for (int i = 0; k % 3 == 2 && i < 3 + k % 50; ++i) {
      // Round-off of a face, at times a bulge.
      const double height = k % 2 ? 1e-9 * uniform(random) : 1e-3 * std::abs(uniform(random));
      points.emplace_back(0.05 * uniform(random), 0.05 * uniform(random), height);
    }
    const Eigen::Vector2d tilt(0.01 * uniform(random), 0.01 * uniform(random));
    for (Eigen::Vector3d& point : points) point.z() += tilt.dot(point.head<2>());
    const std::vector<int> corners = kept(points);
    for (int turn = 0; turn < 20; ++turn) {
      const Eigen::Vector2d gradient(uniform(random), uniform(random));
      const auto gap = [&](int i) {
        const Eigen::Vector3d& point = points[static_cast<std::size_t>(i)];
        return point.z() + gradient.dot(point.head<2>());
      };
      double least = 1e9, least_kept = 1e9;
      for (int i = 0; i < static_cast<int>(points.size()); ++i) least = std::min(least, gap(i));
      for (const int i : corners) least_kept = std::min(least_kept, gap(i));
      EXPECT_LE(least_kept, least + 10.0 * kTolerance) << "case " << k;
    }
  }
}

}  // namespace
}  // namespace pliant
