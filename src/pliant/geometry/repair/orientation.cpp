#include "pliant/geometry/repair/orientation.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace pliant {
namespace {

struct DirectedSide {
  int low, high;  // vertices
  int triangle;
  bool rising;

  bool same_edge(const DirectedSide& other) const { return low == other.low && high == other.high; }
};

std::vector<DirectedSide> sorted_directed_sides(const TriangleMesh& mesh) {
  std::vector<DirectedSide> sides;
  sides.reserve(3 * static_cast<std::size_t>(mesh.triangles.cols()));
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(k, t);
      const int b = mesh.triangles((k + 1) % 3, t);
      sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const DirectedSide& l, const DirectedSide& r) {
    return std::array{l.low, l.high, l.triangle} < std::array{r.low, r.high, r.triangle};
  });
  return sides;
}

}  // namespace

std::vector<TriangleNeighbours> triangle_neighbours(const TriangleMesh& mesh) {
  std::vector<TriangleNeighbours> result;
  const std::vector<DirectedSide> sides = sorted_directed_sides(mesh);
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].same_edge(sides[begin])) ++end;
    if (end - begin == 2) {
      const DirectedSide &a = sides[begin], &b = sides[begin + 1];
      result.push_back({{a.triangle, b.triangle}, a.rising == b.rising});
    }
    begin = end;
  }
  return result;
}

OrientationUnion::OrientationUnion(int count)
    : parent_(static_cast<std::size_t>(count)), flipped_(static_cast<std::size_t>(count), 0) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int OrientationUnion::root(int member) {
  int top = member;
  char flip = 0;
  for (; parent_[top] != top; top = parent_[top]) flip ^= flipped_[top];
  while (parent_[member] != top && member != top) {
    const int next = parent_[member];
    const char rest = flip ^ flipped_[member];
    parent_[member] = top;
    flipped_[member] = flip;
    flip = rest;
    member = next;
  }
  return top;
}

bool OrientationUnion::flipped(int member) {
  root(member);
  return flipped_[member] != 0;
}

bool OrientationUnion::relate(int a, int b, bool opposed) {
  const int root_a = root(a);
  const int root_b = root(b);
  const bool flip = opposed != (flipped(a) != flipped(b));
  if (root_a == root_b) return !flip;
  // The smaller triangle stays the root, so that it decides a draw.
  parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  flipped_[std::max(root_a, root_b)] = flip ? 1 : 0;
  return true;
}

void orient_by_majority(OrientationUnion& sets, TriangleMesh& mesh) {
  const int count = static_cast<int>(mesh.triangles.cols());
  // Of each set's root: members that agree less those that do not.
  std::vector<int> balance(static_cast<std::size_t>(count), 0);
  for (int t = 0; t < count; ++t) balance[sets.root(t)] += sets.flipped(t) ? -1 : 1;
  for (int t = 0; t < count; ++t) {
    const bool root_is_wrong = balance[sets.root(t)] < 0;
    if (sets.flipped(t) != root_is_wrong) std::swap(mesh.triangles(1, t), mesh.triangles(2, t));
  }
}

}  // namespace pliant
