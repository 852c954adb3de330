// Proof of the dihedral angles of stuffed tetrahedra: every stencil, with every way its corners may
// have been moved, by branch and bound.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pliant/geometry/mesh/dihedral_angles.h"
#include "pliant/geometry/meshing/isosurface_stuffing.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "pliant/geometry/meshing/stuffing_stencils.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// A vertex on a segment, its place there any between two shares.
struct Ranged {
  Vector3d from, offset;
  double low = 0.0, high = 0.0;

  Vector3d middle() const { return from + 0.5 * (low + high) * offset; }
  /// No place is farther from the middle [of the lattice's units].
  double reach() const { return 0.5 * (high - low) * offset.norm(); }
};

/// The tetrahedra of the lattice are alike up to its symmetries, which turn the rule of diagonals
/// by parity over: so one of them, with either parity.
constexpr double kCorners[4][3] = {{0, 0, 0}, {2, 0, 0}, {1, 1, 1}, {1, 1, -1}};

std::vector<Vector3d> neighbour_offsets() {
  std::vector<Vector3d> offsets;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-2.0, 2.0}) offsets.push_back(sign * Vector3d::Unit(axis));
  }
  for (int k = 0; k < 8; ++k) {
    offsets.emplace_back((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
  }
  return offsets;
}

/// The points of that tetrahedron with given sides, those on the surface moved along given edges.
class TetrahedronPoints {
 public:
  TetrahedronPoints(std::array<int, 4> sides, std::array<Vector3d, 4> offsets, bool is_mirrored)
      : sides_(sides), offsets_(std::move(offsets)), is_mirrored_(is_mirrored) {
    for (auto& row : cuts_) row.fill(-1);
    corners_.fill(-1);
  }

  int sign(int p) const { return sides_[static_cast<std::size_t>(p)]; }
  bool is_long(int a, int b) const { return a / 2 == b / 2; }
  Eigen::Array3i coordinates(int p) const {
    const Eigen::Array3i at = position(p).cast<int>();
    return is_mirrored_ ? Eigen::Array3i(-at) : at;
  }
  int corner(int p) {
    int& vertex = corners_[static_cast<std::size_t>(p)];
    if (vertex >= 0) return vertex;
    const Vector3d& offset = offsets_[static_cast<std::size_t>(p)];
    const double most = offset.norm() > 1.9 ? kAlphaLong : kAlphaShort;
    return vertex = add({position(p), offset, 0.0, sign(p) == 0 ? most : 0.0});
  }
  int cut(int a, int b) {
    int& vertex = cuts_[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    if (vertex >= 0) return vertex;
    const double least = is_long(a, b) ? kAlphaLong : kAlphaShort;
    return vertex = add({position(a), position(b) - position(a), least, 1.0 - least});
  }
  const std::vector<Ranged>& vertices() const { return vertices_; }

 private:
  static Vector3d position(int p) { return Vector3d(kCorners[p]); }
  int add(const Ranged& vertex) {
    vertices_.push_back(vertex);
    return static_cast<int>(vertices_.size()) - 1;
  }

  std::array<int, 4> sides_;
  std::array<Vector3d, 4> offsets_;
  bool is_mirrored_;
  std::array<int, 4> corners_{};
  std::array<std::array<int, 4>, 4> cuts_{};
  std::vector<Ranged> vertices_;
};

struct Bounds {
  double least, greatest;  // [rad]
};

/// Between which angles the dihedral angle at the edge i - j lies while each vertex moves within
/// its reach of its middle. With heights h over the edge and places s along it of k and l, it
/// changes by at most |dx_k|/h_k + |dx_l|/h_l + (|1 - s_k|/h_k + |1 - s_l|/h_l) |dx_i| + (|s_k|/h_k
/// + |s_l|/h_l) |dx_j|.
Bounds angle_bounds(const Ranged& i, const Ranged& j, const Ranged& k, const Ranged& l) {
  const Vector3d a = i.middle(), edge = j.middle() - a;
  const Vector3d along = edge.normalized();
  const double shortest = edge.norm() - i.reach() - j.reach();
  std::array<Vector3d, 2> up;
  double change = 0.0;
  const std::array<const Ranged*, 2> tips = {&k, &l};
  for (std::size_t n = 0; n < 2; ++n) {
    const Ranged& tip = *tips[n];
    const Vector3d to = tip.middle() - a;
    up[n] = to - to.dot(along) * along;
    const double from_i = to.norm() + tip.reach() + i.reach();
    const double from_j = (to - edge).norm() + tip.reach() + j.reach();
    if (shortest <= 0.0) return {0.0, M_PI};
    const double s = from_i / shortest, rest = from_j / shortest;  // bounds of |s| and |1 - s|
    const double moved = tip.reach() + rest * i.reach() + s * j.reach();
    const double height = up[n].norm() - moved;
    if (height <= 0.0) return {0.0, M_PI};
    change += moved / height;
  }
  const double angle = std::atan2(up[0].cross(up[1]).norm(), up[0].dot(up[1]));
  return {angle - change, angle + change};
}

/// Whether all angles of a tetrahedron lie within these bounds, wherever its vertices are; halves
/// the longest range until that is clear one way or the other. `boxes` counts, so that it ends.
bool lies_within(std::array<Ranged, 4> t, const Bounds& bounds, long& boxes) {
  if (--boxes < 0) return false;
  bool is_clear = true;
  for (std::size_t i = 0; i < 4 && is_clear; ++i) {
    for (std::size_t j = i + 1; j < 4 && is_clear; ++j) {
      const std::size_t k = i == 0 ? (j == 1 ? 2 : 1) : 0, l = 6 - i - j - k;
      const Bounds angle = angle_bounds(t[i], t[j], t[k], t[l]);
      is_clear = angle.least >= bounds.least && angle.greatest <= bounds.greatest;
    }
  }
  if (is_clear) return true;
  Ranged& longest = *std::max_element(
      t.begin(), t.end(), [](const Ranged& a, const Ranged& b) { return a.reach() < b.reach(); });
  constexpr double kSmallest = 1e-6;
  if (longest.reach() < kSmallest) return false;
  const double middle = 0.5 * (longest.low + longest.high), high = longest.high;
  longest.high = middle;
  if (!lies_within(t, bounds, boxes)) return false;
  longest.low = middle;
  longest.high = high;
  return lies_within(t, bounds, boxes);
}

/// Calls visit(tetrahedron) for each that a stencil with these sides may make.
template <class Visit>
void for_each_tetrahedron(const std::array<int, 4>& sides, bool is_mirrored, const Visit& visit) {
  static const std::vector<Vector3d> kOffsets = neighbour_offsets();
  std::vector<std::size_t> on;
  for (std::size_t p = 0; p < 4; ++p) {
    if (sides[p] == 0) on.push_back(p);
  }
  std::size_t choices = 1;
  for (std::size_t n = 0; n < on.size(); ++n) choices *= kOffsets.size();
  for (std::size_t choice = 0; choice < choices; ++choice) {
    std::array<Vector3d, 4> offsets;
    offsets.fill(Vector3d::Zero());
    std::size_t rest = choice;
    for (const std::size_t p : on) {
      offsets[p] = kOffsets[rest % kOffsets.size()];
      rest /= kOffsets.size();
    }
    TetrahedronPoints points(sides, offsets, is_mirrored);
    std::vector<CornerTetrahedron> made;
    StuffingStencils<TetrahedronPoints>(points, made).add_inside_of({0, 1, 2, 3});
    for (const CornerTetrahedron& corners : made) {
      std::array<Ranged, 4> tetrahedron;
      for (std::size_t n = 0; n < 4; ++n) {
        tetrahedron[n] = points.vertices()[static_cast<std::size_t>(corners[n])];
      }
      visit(tetrahedron);
    }
  }
}

template <class Visit>
void for_all_tetrahedra(const Visit& visit) {
  for (int code = 0; code < 81; ++code) {
    const std::array<int, 4> sides = {code % 3 - 1, code / 3 % 3 - 1, code / 9 % 3 - 1,
                                      code / 27 - 1};
    if (*std::max_element(sides.begin(), sides.end()) < 1) continue;  // none inside: not asked
    for (const bool is_mirrored : {false, true}) for_each_tetrahedron(sides, is_mirrored, visit);
  }
}

bool all_lie_within(double least, double greatest) {
  const Bounds bounds{least * M_PI / 180.0, greatest * M_PI / 180.0};
  bool holds = true;
  for_all_tetrahedra([&](const std::array<Ranged, 4>& tetrahedron) {
    constexpr long kMostBoxes = 2'000'000;
    long boxes = kMostBoxes;
    holds = holds && lies_within(tetrahedron, bounds, boxes);
  });
  return holds;
}

TEST(StuffingBounds, HoldForEveryTetrahedronThatThereCanBe) {
  EXPECT_TRUE(all_lie_within(kStuffingLeastAngle, kStuffingGreatestAngle));
}

TEST(StuffingBounds, NarrowerOnesDoNot) {
  EXPECT_FALSE(all_lie_within(kStuffingLeastAngle + 0.1, kStuffingGreatestAngle));
  EXPECT_FALSE(all_lie_within(kStuffingLeastAngle, kStuffingGreatestAngle - 0.1));
}

TEST(StuffingBounds, AMeshComesNearThem) {
  // A and C inside, D outside, B moved almost 0.39 of the edge to C; all cuts at their limits.
  DistanceGrid grid;
  grid.origin.setZero();
  grid.spacing = 0.5;
  grid.count.setConstant(15);
  grid.samples.assign(15 * 15 * 15, 0.99f);
  const auto sample = [&](int x, int y, int z) -> float& {
    return grid.samples[static_cast<std::size_t>((z * 15 + y) * 15 + x)];
  };
  sample(6, 6, 6) = -0.64f;
  sample(8, 6, 6) = 1.91f;
  sample(7, 7, 7) = -2.99f;
  sample(7, 7, 5) = 1.0f;
  const AngleRange angles = dihedral_angles(stuff_negative(grid));
  EXPECT_LT(angles.least, kStuffingLeastAngle + 0.2);
  EXPECT_GT(angles.greatest, kStuffingGreatestAngle - 0.5);
  EXPECT_GE(angles.least, kStuffingLeastAngle);
  EXPECT_LE(angles.greatest, kStuffingGreatestAngle);
}

}  // namespace
}  // namespace pliant
