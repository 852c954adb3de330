#include "pliant/elements/coloring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "support/random.h"

namespace pliant {
namespace {

void expect_valid(const Coloring& coloring, const std::vector<int>& vertices, int arity) {
  const int elements = static_cast<int>(vertices.size()) / arity;
  std::vector<int> sorted = coloring.order, all(static_cast<std::size_t>(elements));
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  ASSERT_EQ(sorted, all);
  ASSERT_EQ(coloring.begins.front(), 0);
  ASSERT_EQ(coloring.begins.back(), elements);
  for (int c = 0; c < coloring.colors(); ++c) {
    std::set<int> seen;
    const auto color = static_cast<std::size_t>(c);
    ASSERT_LT(coloring.begins[color], coloring.begins[color + 1]) << "colour " << c << " is empty";
    for (int place = coloring.begins[color]; place < coloring.begins[color + 1]; ++place) {
      const int e = coloring.order[static_cast<std::size_t>(place)];
      for (int k = 0; k < arity; ++k) {
        const int v = vertices[static_cast<std::size_t>(e * arity + k)];
        ASSERT_TRUE(seen.insert(v).second) << "particle " << v << " twice in colour " << c;
      }
    }
  }
}

TEST(Coloring, NoElements) {
  const Coloring coloring = color_elements({}, 2, 10);
  EXPECT_EQ(coloring.colors(), 0);
  EXPECT_TRUE(coloring.order.empty());
}

TEST(Coloring, AChainNeedsTwoColours) {
  std::vector<int> vertices;
  for (int i = 0; i < 100; ++i) vertices.insert(vertices.end(), {i, i + 1});
  const Coloring coloring = color_elements(vertices, 2, 101);
  EXPECT_EQ(coloring.colors(), 2);
  expect_valid(coloring, vertices, 2);
}

TEST(Coloring, MoreThan64Colours) {
  // Every element holds particle 0: each needs a colour of its own.
  std::vector<int> vertices;
  for (int i = 1; i <= 200; ++i) vertices.insert(vertices.end(), {0, i});
  const Coloring coloring = color_elements(vertices, 2, 201);
  EXPECT_EQ(coloring.colors(), 200);
  expect_valid(coloring, vertices, 2);
}

TEST(Coloring, ExactlyAtTheEndOfARound) {
  for (const int spokes : {63, 64, 65, 128, 129}) {
    std::vector<int> vertices;
    for (int i = 1; i <= spokes; ++i) vertices.insert(vertices.end(), {0, i});
    const Coloring coloring = color_elements(vertices, 2, spokes + 1);
    EXPECT_EQ(coloring.colors(), spokes);
    expect_valid(coloring, vertices, 2);
  }
}

TEST(Coloring, RandomElementsOfFour) {
  Random random(7);
  std::vector<int> vertices;
  for (int e = 0; e < 2000; ++e) {
    std::set<int> four;
    while (four.size() < 4) four.insert(static_cast<int>(random(0, 150)));
    vertices.insert(vertices.end(), four.begin(), four.end());
  }
  expect_valid(color_elements(vertices, 4, 150), vertices, 4);
}

TEST(Coloring, ElementsOfDifferentSizes) {
  const std::vector<int> vertices = {0, 1, 2, 2, 3, 4, 5, 6, 0, 6};
  const Coloring coloring = color_elements(vertices, {0, 3, 4, 8, 10}, 7);
  EXPECT_EQ(coloring.begins, (std::vector<int>{0, 2, 4}));
  // {0 1 2} and {3 4 5 6}, then {2} and {0 6}.
  EXPECT_EQ(coloring.order, (std::vector<int>{0, 2, 1, 3}));
}

}  // namespace
}  // namespace pliant
