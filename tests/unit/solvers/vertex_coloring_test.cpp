#include "pliant/solvers/linear/vertex_coloring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/random.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

using Edge = std::pair<int, int>;

SparseRows graph(int size, const std::vector<Edge>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 4.0);
  for (const auto& [i, j] : edges) {
    entries.emplace_back(i, j, -1.0);
    entries.emplace_back(j, i, -1.0);
  }
  SparseRows a(size, size);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

Particles free_particles(int size) {
  return Particles(Positions::Zero(3, size), Eigen::VectorXd::Ones(size));
}

constexpr int kUncolored = -1;

/// Each particle's colour; fails where a particle is listed twice, or none is.
std::vector<int> colors_of(const VertexColoring& coloring, const Particles& particles) {
  std::vector<int> color(static_cast<std::size_t>(particles.size()), kUncolored);
  std::vector<int> times(color.size(), 0);
  for (std::size_t c = 0; c < coloring.colors.size(); ++c) {
    for (int i : coloring.colors[c]) {
      color[static_cast<std::size_t>(i)] = static_cast<int>(c);
      ++times[static_cast<std::size_t>(i)];
    }
  }
  for (int i : coloring.overflow) ++times[static_cast<std::size_t>(i)];
  for (int i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(times[static_cast<std::size_t>(i)], particles.is_fixed(i) ? 0 : 1) << i;
  }
  return color;
}

/// No two of a colour share an entry; what overflowed has a neighbour of every colour.
void expect_proper(const VertexColoring& coloring, const SparseRows& a,
                   const Particles& particles) {
  const std::vector<int> color = colors_of(coloring, particles);
  for (int i = 0; i < a.rows(); ++i) {
    std::vector<char> seen(coloring.colors.size(), 0);
    const int own = color[static_cast<std::size_t>(i)];
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
      const int other = color[static_cast<std::size_t>(entry.col())];
      if (entry.col() == i || other == kUncolored) continue;
      ASSERT_NE(own, other) << i << " and " << entry.col();
      seen[static_cast<std::size_t>(other)] = 1;
    }
    if (own != kUncolored || particles.is_fixed(i)) continue;
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<int>(seen.size())) << i;
  }
}

/// A net in which the largest row has about thrice the entries of the mean.
struct RandomGraph {
  RandomGraph() : particles(free_particles(500)) {
    Random random(11);
    std::vector<Edge> edges;
    for (int k = 0; k < 2000; ++k) {
      const int i = static_cast<int>(random(0, 500)), j = static_cast<int>(random(0, 500));
      if (i != j) edges.emplace_back(i, j);
    }
    a = graph(500, edges);
    for (int i = 0; i < 500; i += 17) particles.fix(i);
  }
  Particles particles;
  SparseRows a;
};

TEST(VertexColoring, IsProper) {
  const RandomGraph net;
  const VertexColoring coloring = color_vertices(net.a, net.particles, 0);
  expect_proper(coloring, net.a, net.particles);
  EXPECT_TRUE(coloring.overflow.empty());
}

TEST(VertexColoring, NeedsNoMoreColoursThanTheLongestRowHasEntries) {
  const RandomGraph net;
  const VertexColoring coloring = color_vertices(net.a, net.particles, 0);
  Eigen::Index longest = 0;
  for (int i = 0; i < net.a.rows(); ++i) longest = std::max(longest, net.a.row(i).nonZeros());
  EXPECT_LE(static_cast<Eigen::Index>(coloring.colors.size()), longest);
}

TEST(VertexColoring, BoundedColoursOverflow) {
  const RandomGraph net;
  std::size_t last = 1000;
  for (const int most : {1, 2, 3, 5, 8}) {
    const VertexColoring coloring = color_vertices(net.a, net.particles, most);
    EXPECT_LE(static_cast<int>(coloring.colors.size()), most);
    expect_proper(coloring, net.a, net.particles);
    EXPECT_LE(coloring.overflow.size(), last) << most;
    last = coloring.overflow.size();
  }
  EXPECT_GT(color_vertices(net.a, net.particles, 1).overflow.size(), 0u);
  EXPECT_EQ(color_vertices(net.a, net.particles, 64).overflow.size(), 0u);
}

TEST(VertexColoring, FreeChoiceIsPerfectlyBalanced) {
  const VertexColoring coloring = color_vertices(graph(1001, {}), free_particles(1001), 7);
  for (const auto& color : coloring.colors) EXPECT_EQ(color.size(), 143u);
}

TEST(VertexColoring, ColoursOfASheetAreOfAboutTheSameSize) {
  // 41 x 41 vertices; hinges tie up to 12 others to each. A parallel loop over a colour is as good
  // as its size: a greedy colouring by the first free colour leaves colours of a few vertices.
  const ProjectiveSystem system = bending_sheet(make_grid({1, 1, 41, 41}), 1e-4);
  const SparseRows a = projective_matrix(system, 0.01);
  for (const int most : {0, 16}) {
    const VertexColoring coloring = color_vertices(a, system.particles, most);
    expect_proper(coloring, a, system.particles);
    std::size_t smallest = 10000, total = 0;
    for (const auto& color : coloring.colors) {
      smallest = std::min(smallest, color.size());
      total += color.size();
    }
    EXPECT_GE(smallest, total / coloring.colors.size() / 2) << most;
  }
}

TEST(VertexColoring, APathHasTwoColours) {
  std::vector<Edge> edges;
  for (int i = 0; i + 1 < 100; ++i) edges.emplace_back(i, i + 1);
  const VertexColoring coloring = color_vertices(graph(100, edges), free_particles(100), 0);
  ASSERT_EQ(coloring.colors.size(), 2u);
  EXPECT_EQ(coloring.colors[0].size(), 50u);
}

TEST(VertexColoring, ACompleteGraphHasAColourEach) {
  std::vector<Edge> edges;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) edges.emplace_back(i, j);
  }
  const SparseRows a = graph(6, edges);
  EXPECT_EQ(color_vertices(a, free_particles(6), 0).colors.size(), 6u);
  EXPECT_EQ(color_vertices(a, free_particles(6), 2).overflow.size(), 4u);
}

TEST(VertexColoring, SumsOfTheOverflowLeaveOutItsDiagonalAndWhatIsColoured) {
  // A complete graph of four with two colours: two of them overflow, which share one entry of -1.
  const SparseRows a = graph(4, {{1, 0}, {2, 0}, {3, 0}, {2, 1}, {3, 1}, {3, 2}});
  const VertexColoring coloring = color_vertices(a, free_particles(4), 2);
  ASSERT_EQ(coloring.overflow, std::vector<int>({2, 3}));
  EXPECT_EQ(overflow_row_sums(a, coloring), Eigen::VectorXd(Eigen::Vector4d(0.0, 0.0, 1.0, 1.0)));
}

TEST(VertexColoring, OneParticleNoneAndAllFixed) {
  EXPECT_EQ(color_vertices(graph(1, {}), free_particles(1), 0).colors[0].size(), 1u);
  EXPECT_TRUE(color_vertices(graph(0, {}), free_particles(0), 0).overflow.empty());
  Particles fixed = free_particles(3);
  for (int i = 0; i < 3; ++i) fixed.fix(i);
  const VertexColoring coloring = color_vertices(graph(3, {{0, 1}, {1, 2}}), fixed, 0);
  for (const auto& color : coloring.colors) EXPECT_TRUE(color.empty());
  EXPECT_TRUE(coloring.overflow.empty());
}

TEST(VertexColoring, IsTheSameEveryTime) {
  const RandomGraph net;
  const VertexColoring first = color_vertices(net.a, net.particles, 4);
  const VertexColoring second = color_vertices(net.a, net.particles, 4);
  EXPECT_EQ(first.colors, second.colors);
  EXPECT_EQ(first.overflow, second.overflow);
}

}  // namespace
}  // namespace pliant
