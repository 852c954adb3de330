#include "pliant/geometry/search/nearest_pair.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace pliant {
namespace {

/// The least distance over a fine grid of weights: never below the true one.
double sampled_distance(SimplexPair kind, const FourPoints& x, int n = 60) {
  double least = INFINITY;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / n;
      Eigen::Vector4d w;
      if (kind == SimplexPair::kSegments) {
        w << 1.0 - s, s, t - 1.0, -t;
      } else {
        if (i + j > n) continue;
        w << 1.0, s + t - 1.0, -s, -t;
      }
      least = std::min(least, (x * w).norm());
    }
  }
  return least;
}

class NearestPair : public testing::TestWithParam<SimplexPair> {};

INSTANTIATE_TEST_SUITE_P(Kinds, NearestPair,
                         testing::Values(SimplexPair::kPointTriangle, SimplexPair::kSegments),
                         [](const auto& info) {
                           return info.param == SimplexPair::kSegments ? "segments"
                                                                       : "point_triangle";
                         });

TEST_P(NearestPair, IsNoFartherThanAnySampleAndNotMuchNearer) {
  std::srand(7);
  for (int trial = 0; trial < 50; ++trial) {
    const FourPoints x = FourPoints::Random();
    const Eigen::Vector4d w = nearest_pair(GetParam(), x);
    const int first = GetParam() == SimplexPair::kSegments ? 2 : 1;
    EXPECT_NEAR(w.head(first).sum(), 1.0, 1e-12);
    EXPECT_NEAR(w.tail(4 - first).sum(), -1.0, 1e-12);
    EXPECT_GE(w.head(first).minCoeff(), -1e-12);
    EXPECT_LE(w.tail(4 - first).maxCoeff(), 1e-12);
    const double sampled = sampled_distance(GetParam(), x);
    EXPECT_LE((x * w).norm(), sampled + 1e-12);
    // Samples lie within half a cell's diagonals of the nearest points.
    EXPECT_GE((x * w).norm(), sampled - 2.0 * std::sqrt(12.0) / 60.0);
  }
}

TEST_P(NearestPair, TakesDegenerateOnes) {
  FourPoints x;
  for (int shape = 0; shape < 4; ++shape) {
    x.setZero();
    x(2, 0) = 1.0;  // a point over the rest
    if (shape == 0) x.col(1) = x.col(0);
    if (shape == 1) x.row(0) << 0.0, -1.0, 0.5, 2.0;
    if (shape == 2) x.row(1) << 0.3, 0.3, 0.3, 0.3;
    if (shape == 3) x.setZero();
    const Eigen::Vector4d w = nearest_pair(GetParam(), x);
    ASSERT_TRUE(w.allFinite()) << shape;
    EXPECT_LE((x * w).norm(), sampled_distance(GetParam(), x) + 1e-12) << shape;
  }
}

TEST_P(NearestPair, OfParallelSegmentsOrInThePlane) {
  FourPoints x;
  x << 0.2, 0.8, 0.0, 1.0,  //
      0.0, 0.0, 0.0, 0.0,   //
      0.1, 0.1, 0.0, 0.0;
  if (GetParam() == SimplexPair::kSegments) {
    EXPECT_NEAR((x * nearest_pair(GetParam(), x)).norm(), 0.1, 1e-12);
  } else {
    x(1, 3) = 1.0;
    EXPECT_NEAR((x * nearest_pair(GetParam(), x)).norm(), sampled_distance(GetParam(), x, 400),
                1e-2);
  }
}

/// The first simplex one metre over the second one, both around the origin.
FourPoints apart(SimplexPair kind) {
  FourPoints x;
  if (kind == SimplexPair::kSegments) {
    x << -1, 1, 0, 0,  //
        0, 0, -1, 1,   //
        1, 1, 0, 0;
  } else {
    x << 0, -1, 1, 0,  //
        0, -1, -1, 1,  //
        1, 0, 0, 0;
  }
  return x;
}

TEST_P(NearestPair, FindsAnApproachHoweverFast) {
  const FourPoints start = apart(GetParam());
  const int first = GetParam() == SimplexPair::kSegments ? 2 : 1;
  for (const double travel : {1.0, 3.0, 1000.0}) {
    FourPoints end = start;
    end.row(2).head(first).array() -= travel;
    Approach found;
    ASSERT_TRUE(find_approach(GetParam(), start, end, 0.01, found)) << travel;
    EXPECT_NEAR(found.time, 0.99 / travel, 0.002 / travel) << "between 0.9 and 1 reach";
    EXPECT_NEAR(found.between.normalized().z(), 1.0, 1e-9);
  }
  FourPoints end = start;
  end.row(2).head(first).array() -= 0.98;
  Approach found;
  EXPECT_FALSE(find_approach(GetParam(), start, end, 0.01, found)) << "stops before";
  end = start;
  end.row(0).head(first).array() += 5.0;
  EXPECT_FALSE(find_approach(GetParam(), start, end, 0.01, found)) << "passes by";
  EXPECT_FALSE(find_approach(GetParam(), start, start, 0.01, found)) << "does not move";
  EXPECT_TRUE(find_approach(GetParam(), start, start, 1.5, found)) << "is near";
  EXPECT_EQ(found.time, 0.0);
}

TEST_P(NearestPair, WhatIsNotFiniteNeverMeets) {
  const FourPoints start = apart(GetParam());
  for (const double bad : {std::nan(""), double{INFINITY}}) {
    FourPoints end = start;
    end(1, 2) = bad;
    Approach found;
    EXPECT_FALSE(find_approach(GetParam(), start, end, 0.01, found));
  }
}

}  // namespace
}  // namespace pliant
