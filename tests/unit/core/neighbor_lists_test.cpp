#include "pliant/core/system/neighbor_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

Eigen::Matrix3Xd cloud(int count, double scale) {
  Eigen::Matrix3Xd points(3, count);
  unsigned state = 1;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    state = 1664525u * state + 1013904223u;
    points.data()[k] = scale * (static_cast<double>(state) / 4294967296.0 - 0.5);
  }
  return points;
}

std::set<std::pair<int, int>> pairs(const NeighborLists& lists) {
  std::set<std::pair<int, int>> found;
  for (int k = 0; k < lists.size(); ++k) {
    for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
      const bool is_new = found
                              .emplace(lists.order()[static_cast<std::size_t>(k)],
                                       lists.order()[static_cast<std::size_t>(*j)])
                              .second;
      EXPECT_TRUE(is_new) << "twice";
    }
  }
  return found;
}

std::set<std::pair<int, int>> pairs_by_force(const Eigen::Matrix3Xd& points, double radius) {
  std::set<std::pair<int, int>> found;
  for (int i = 0; i < points.cols(); ++i) {
    for (int j = 0; j < points.cols(); ++j) {
      const double distance = (points.col(i) - points.col(j)).norm();
      if (i != j && distance < radius) found.emplace(i, j);
    }
  }
  return found;
}

TEST(NeighborLists, FindsAllPairsAndNoOthers) {
  NeighborLists lists;
  for (double scale : {1e-6, 1.0, 1e6}) {
    const Eigen::Matrix3Xd points = cloud(400, scale).colwise() + Eigen::Vector3d(3e7, -2.0, 0.0);
    for (double radius : {0.05 * scale, 0.2 * scale, 2.0 * scale}) {
      lists.build(points, radius);
      EXPECT_EQ(pairs(lists), pairs_by_force(points, radius)) << scale << " " << radius;
    }
  }
}

TEST(NeighborLists, FarPointsCostNoMemory) {
  Eigen::Matrix3Xd points = cloud(100, 1.0);
  points.col(7) = Eigen::Vector3d(1e12, 0.0, 0.0);
  points.col(8) = Eigen::Vector3d(1e12, 0.01, 0.0);
  points.col(9) = Eigen::Vector3d(-1e15, -1e15, 1e15);
  NeighborLists lists;
  lists.build(points, 0.3);
  EXPECT_EQ(pairs(lists), pairs_by_force(points, 0.3));
}

TEST(NeighborLists, EmptySingleAndCoincidentPoints) {
  NeighborLists lists;
  lists.build(Eigen::Matrix3Xd(3, 0), 1.0);
  EXPECT_EQ(lists.size(), 0);
  lists.build(Eigen::Matrix3Xd::Zero(3, 1), 1.0);
  EXPECT_EQ(lists.end(0) - lists.begin(0), 0);
  lists.build(Eigen::Matrix3Xd::Zero(3, 5), 1.0);
  EXPECT_EQ(lists.end(4) - lists.begin(4), 4);
}

// Few cubes are counted, many compared: a point far away makes the cubes many.
TEST(NeighborLists, OrderIsTheSameHoweverItIsFound) {
  constexpr int kPoints = 300;
  Eigen::Matrix3Xd points = cloud(kPoints + 1, 1.0);
  points.col(kPoints) = points.col(0);
  NeighborLists counted, compared;
  counted.build(points, 0.2);
  // Last in every order, and no cube's number changes.
  points.col(kPoints) = Eigen::Vector3d(1e3, 1e3, 1e3);
  compared.build(points, 0.2);
  std::vector<int> order = counted.order();
  order.erase(std::find(order.begin(), order.end(), kPoints));
  ASSERT_EQ(compared.order().back(), kPoints);
  EXPECT_EQ(order, std::vector<int>(compared.order().begin(), compared.order().end() - 1));
}

TEST(NeighborLists, AreTheSameForAnyNumberOfThreads) {
  const Eigen::Matrix3Xd points = cloud(5000, 1.0);
  std::vector<int> first;
  for (int count : {1, 2, 4}) {
    set_threads(count);
    NeighborLists lists;
    lists.build(points, 0.08);
    std::vector<int> all = lists.order();
    for (int k = 0; k < lists.size(); ++k) all.insert(all.end(), lists.begin(k), lists.end(k));
    if (first.empty()) first = all;
    EXPECT_TRUE(all == first) << count;
  }
  set_threads(1);
}

}  // namespace
}  // namespace pliant
