#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "pliant/geometry/mesh/stencils.h"

namespace pliant {

/// A cut point nearer to a lattice point than that share of the edge moves the point onto the
/// surface. Of the values tried, these kept the least dihedral angle greatest in 400 grids of noise
/// made to come near them.
constexpr double kAlphaShort = 0.39;
constexpr double kAlphaLong = 0.25;

/// Replaces a tetrahedron of the lattice by what of it lies inside (Labelle and Shewchuk 2007,
/// section 3). `Points` knows of lattice points
///   int sign(p): 1 inside, 0 on the surface, -1 outside,
///   int corner(p), int cut(inside, outside): the vertex at a point, and where an edge is cut,
///   bool is_long(a, b), Eigen::Array3i coordinates(p).
template <class Points>
class StuffingStencils {
 public:
  StuffingStencils(Points& points, std::vector<CornerTetrahedron>& result)
      : points_(points), result_(result) {}

  void add_inside_of(const std::array<int, 4>& tetrahedron) {
    for (auto& each : sorted_) each.clear();
    for (const int p : tetrahedron) {
      sorted_[static_cast<std::size_t>(points_.sign(p) + 1)].push_back(p);
    }
    const auto& [out, on, in] = sorted_;
    if (in.size() == 1 || out.empty()) {
      add_tetrahedron(in, on, out);
    } else if (in.size() == 2 && out.size() == 1) {
      add_pyramid(in[0], in[1], on[0], out[0]);
    } else if (in.size() == 2) {
      add_wedge(in[0], in[1], out[0], out[1]);
    } else {
      add_truncated(in, out[0]);
    }
  }

 private:
  /// The face a, b, n is cut between n, outside, and the other two. Its quadrilateral's diagonal
  /// starts at a where true, at b where not, and ends in the other's cut point. Neighbours that
  /// share the face agree, since only the face is asked (the paper's rule: from the end of a cut
  /// long edge; where both cut edges are short, by the parity of the points' coordinates).
  bool diagonal_from_first(int a, int b, int n) const {
    if (points_.is_long(a, n)) return false;
    if (points_.is_long(b, n)) return true;
    const auto greater = (points_.coordinates(a) > points_.coordinates(n)).count();
    return greater % 2 == 0;
  }

  void add_tetrahedron(const std::vector<int>& in, const std::vector<int>& on,
                       const std::vector<int>& out) {
    CornerTetrahedron corners{};
    std::size_t n = 0;
    for (const int p : in) corners[n++] = points_.corner(p);
    for (const int p : on) corners[n++] = points_.corner(p);
    for (const int p : out) corners[n++] = points_.cut(in[0], p);
    result_.push_back(corners);
  }

  void add_pyramid(int a, int b, int apex, int n) {
    const int cut_a = points_.cut(a, n), cut_b = points_.cut(b, n);
    const bool from_a = diagonal_from_first(a, b, n);
    const int other = from_a ? cut_b : cut_a;
    result_.push_back({points_.corner(apex), points_.corner(a), points_.corner(b), other});
    const int end = points_.corner(from_a ? a : b);
    result_.push_back({points_.corner(apex), cut_a, cut_b, end});
  }

  void add_wedge(int a, int b, int n, int m) {
    // The rules of the two faces that the wedge shares with other tetrahedra give diagonals from
    // different ends of a - b; the third, on the surface, joins their other ends.
    const bool from_a = diagonal_from_first(a, b, n);
    cut_prism({points_.corner(a), points_.cut(a, n), points_.cut(a, m)},
              {points_.corner(b), points_.cut(b, n), points_.cut(b, m)},
              {from_a, !from_a, !diagonal_from_first(a, b, m)}, result_);
  }

  void add_truncated(const std::vector<int>& in, int n) {
    cut_prism({points_.corner(in[0]), points_.corner(in[1]), points_.corner(in[2])},
              {points_.cut(in[0], n), points_.cut(in[1], n), points_.cut(in[2], n)},
              {diagonal_from_first(in[0], in[1], n), diagonal_from_first(in[1], in[2], n),
               diagonal_from_first(in[2], in[0], n)},
              result_);
  }

  Points& points_;
  std::vector<CornerTetrahedron>& result_;
  std::array<std::vector<int>, 3> sorted_;  // points of one tetrahedron by side
};

}  // namespace pliant
