#include "pliant/solvers/linear/vertex_coloring.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

constexpr int kNone = -1;

/// Number of the emptiest colour that is not marked with `stamp`, or none.
int emptiest(const std::vector<std::vector<int>>& colors, const std::vector<int>& marks,
             int stamp) {
  int best = kNone;
  for (std::size_t c = 0; c < colors.size(); ++c) {
    if (marks[c] == stamp) continue;
    if (best == kNone || colors[c].size() < colors[static_cast<std::size_t>(best)].size()) {
      best = static_cast<int>(c);
    }
  }
  return best;
}

/// The fewest colours that surely suffice is the longest row; with fewer a greedy pass may fail.
std::size_t longest_row(const SparseRows& a) {
  int longest = 1;
  for (int i = 0; i < a.rows(); ++i) {
    longest = std::max(longest, a.outerIndexPtr()[i + 1] - a.outerIndexPtr()[i]);
  }
  return static_cast<std::size_t>(longest);
}

}  // namespace

VertexColoring color_vertices(const SparseRows& a, const Particles& particles, int max_colors) {
  VertexColoring result;
  const std::size_t most = max_colors > 0 ? static_cast<std::size_t>(max_colors) : longest_row(a);
  result.colors.resize(max_colors > 0 ? most : 1);
  std::vector<int> color(static_cast<std::size_t>(a.rows()), kNone);
  std::vector<int> marks(most, kNone);
  for (int i = 0; i < a.rows(); ++i) {
    if (particles.is_fixed(i)) continue;
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
      const int neighbour = color[static_cast<std::size_t>(entry.col())];
      if (neighbour != kNone) marks[static_cast<std::size_t>(neighbour)] = i;
    }
    int chosen = emptiest(result.colors, marks, i);
    if (chosen == kNone && result.colors.size() < most) {
      chosen = static_cast<int>(result.colors.size());
      result.colors.emplace_back();
    }
    if (chosen == kNone) {
      result.overflow.push_back(i);
      continue;
    }
    color[static_cast<std::size_t>(i)] = chosen;
    result.colors[static_cast<std::size_t>(chosen)].push_back(i);
  }
  return result;
}

Eigen::VectorXd overflow_row_sums(const SparseRows& a, const VertexColoring& coloring) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(a.rows());
  std::vector<char> in_overflow(static_cast<std::size_t>(a.rows()), 0);
  for (int i : coloring.overflow) in_overflow[static_cast<std::size_t>(i)] = 1;
  for (int i : coloring.overflow) {
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
      const bool other = entry.col() != i && in_overflow[static_cast<std::size_t>(entry.col())];
      if (other) sums[i] += std::abs(entry.value());
    }
  }
  return sums;
}

}  // namespace pliant
