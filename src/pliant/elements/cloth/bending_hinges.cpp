#include "pliant/elements/cloth/bending_hinges.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/elements/cloth/warp_direction.h"

namespace pliant {
namespace {

/// Cotangent of the angle between `a` and `b`, and twice their triangle's area.
double cotangent(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.dot(b) / a.cross(b).norm();
}

/// Of the angle between an edge and the warp of the triangle that it spans with `other`.
double squared_cosine(const Eigen::Vector3d& warp, const Eigen::Vector3d& edge,
                      const Eigen::Vector3d& other) {
  const Eigen::Vector3d within = warp_within(warp.normalized(), edge.cross(other).normalized());
  const double cosine = within.dot(edge.normalized());
  return cosine * cosine;
}

}  // namespace

std::vector<BendingHinge> hinges_of_mesh(const TriangleMesh& rest, const Eigen::Vector3d& warp,
                                         const BendingStiffness& stiffness) {
  const Edges mesh_edges = edges(rest);
  std::vector<BendingHinge> hinges;
  for (std::size_t e = 0; e < mesh_edges.vertices.size(); ++e) {
    const auto [i, j] = mesh_edges.vertices[e];
    const auto [k, l] = mesh_edges.opposite[e];
    if (k < 0 || l < 0) continue;
    const Eigen::Vector3d xi = rest.vertices.col(i), xj = rest.vertices.col(j);
    const Eigen::Vector3d xk = rest.vertices.col(k), xl = rest.vertices.col(l);
    const double ik = cotangent(xj - xi, xk - xi), il = cotangent(xj - xi, xl - xi);
    const double jk = cotangent(xi - xj, xk - xj), jl = cotangent(xi - xj, xl - xj);
    const double areas = 0.5 * ((xj - xi).cross(xk - xi).norm() + (xj - xi).cross(xl - xi).norm());
    BendingHinge hinge;
    hinge.vertices = {i, j, k, l};
    hinge.weights = {jk + jl, ik + il, -ik - jk, -il - jl};
    double own = stiffness.warp;
    if (stiffness.warp != stiffness.weft) {
      const double along =
          0.5 * (squared_cosine(warp, xj - xi, xk - xi) + squared_cosine(warp, xj - xi, xl - xi));
      own = std::pow(stiffness.warp, 1.0 - along) * std::pow(stiffness.weft, along);
    }
    hinge.stiffness = own / areas;
    hinges.push_back(hinge);
  }
  return hinges;
}

std::vector<BendingHinge> hinges_of_grid(const GridOptions& grid, const BendingStiffness& stiffness,
                                         bool to_edges) {
  const double a = grid.width / (grid.columns - 1), b = grid.height / (grid.rows - 1);
  const auto along = [&](int index, int count) {
    return to_edges ? share_along(index, count) : 1.0;
  };
  std::vector<BendingHinge> hinges;
  hinges.reserve(3 * static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.columns));
  const auto add_line = [&](int i, int step, int beside, double own) {
    hinges.push_back({{i - step, i, i + step, beside}, {1.0, -2.0, 1.0, 0.0}, own});
  };
  const double twist = 2.0 * std::sqrt(stiffness.warp * stiffness.weft) / (a * b);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      const int i = r * grid.columns + c, up = grid.columns;
      if (c > 0 && c + 1 < grid.columns) {
        const double share = share_across(r, grid.rows) * along(c, grid.columns);
        add_line(i, 1, r + 1 < grid.rows ? i + up : i - up,
                 stiffness.warp * share * b / (a * a * a));
      }
      if (r > 0 && r + 1 < grid.rows) {
        const double share = share_across(c, grid.columns) * along(r, grid.rows);
        add_line(i, up, c + 1 < grid.columns ? i + 1 : i - 1,
                 stiffness.weft * share * a / (b * b * b));
      }
      if (c + 1 < grid.columns && r + 1 < grid.rows) {
        hinges.push_back({{i, i + up + 1, i + 1, i + up}, {1.0, 1.0, -1.0, -1.0}, twist});
      }
    }
  }
  return hinges;
}

BendingStencils bending_of(const std::vector<BendingHinge>& hinges) {
  BendingStencils stencils;
  stencils.vertices.reserve(4 * hinges.size());
  stencils.weights.reserve(4 * hinges.size());
  stencils.firsts.reserve(hinges.size() + 1);
  for (const BendingHinge& piece : hinges) {
    for (std::size_t k = 0; k < 4; ++k) {
      // The vertex beside a line of a grid. Weights of a mesh's edge may be 0 or its round-off, but
      // for those of the vertices opposite to it; the order of the pieces must not hang on that.
      if (k == 3 && piece.weights[k] == 0.0) continue;
      stencils.vertices.push_back(piece.vertices[k]);
      stencils.weights.push_back(std::sqrt(piece.stiffness) * piece.weights[k]);
    }
    stencils.firsts.push_back(static_cast<int>(stencils.vertices.size()));
  }
  return stencils;
}

}  // namespace pliant
