#include "pliant/geometry/search/box_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

using HierarchyBox = BoxHierarchy::Box;

std::vector<HierarchyBox> random_boxes(int count, double size) {
  std::vector<HierarchyBox> boxes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d middle = Eigen::Vector3d::Random();
    const Eigen::Vector3d half = size * Eigen::Vector3d::Random().cwiseAbs();
    boxes.emplace_back(middle - half, middle + half);
  }
  return boxes;
}

std::vector<int> found(const BoxHierarchy& hierarchy, const HierarchyBox& box) {
  std::vector<int> indices;
  hierarchy.for_each_overlapping(box, [&](int i) { indices.push_back(i); });
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<int> expected(const std::vector<HierarchyBox>& boxes, const HierarchyBox& box) {
  std::vector<int> indices;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    if (boxes[k].intersects(box)) indices.push_back(static_cast<int>(k));
  }
  return indices;
}

TEST(BoxHierarchy, FindsWhatMeetsABox) {
  std::srand(3);
  for (const int count : {0, 1, 4, 5, 300}) {
    const std::vector<HierarchyBox> boxes = random_boxes(count, 0.1);
    BoxHierarchy hierarchy;
    hierarchy.build(boxes);
    for (const HierarchyBox& box : random_boxes(40, 0.4)) {
      EXPECT_EQ(found(hierarchy, box), expected(boxes, box));
    }
  }
}

TEST(BoxHierarchy, FollowsBoxesThatMove) {
  std::srand(4);
  BoxHierarchy hierarchy;
  hierarchy.build(random_boxes(100, 0.1));
  const std::vector<HierarchyBox> moved = random_boxes(100, 0.2);
  hierarchy.refit(moved);
  for (const HierarchyBox& box : random_boxes(40, 0.4)) {
    EXPECT_EQ(found(hierarchy, box), expected(moved, box));
  }
}

TEST(BoxHierarchy, ManyEqualBoxes) {
  const HierarchyBox unit(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  BoxHierarchy hierarchy;
  hierarchy.build(std::vector<HierarchyBox>(1000, unit));
  EXPECT_EQ(found(hierarchy, unit).size(), 1000u);
}

TEST(BoxHierarchy, WhatIsNotFiniteMeetsNothing) {
  std::vector<HierarchyBox> boxes = random_boxes(10, 0.1);
  boxes[3].max()[1] = std::nan("");
  boxes[7].min()[0] = -INFINITY;
  BoxHierarchy hierarchy;
  hierarchy.build(boxes);
  const HierarchyBox all(Eigen::Vector3d::Constant(-9.0), Eigen::Vector3d::Constant(9.0));
  EXPECT_EQ(found(hierarchy, all).size(), 8u);
}

}  // namespace
}  // namespace pliant
