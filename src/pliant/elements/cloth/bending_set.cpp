#include "pliant/elements/cloth/bending_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/cloth/warp_direction.h"
#include "pliant/elements/coloring.h"
#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024;  // in less, threads cost more than they save

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

void check_stiffness(double stiffness) {
  if (std::isfinite(stiffness) && stiffness > 0.0) return;
  throw InputError(fmt::format("bending stiffness is {} N m, but must be positive", stiffness));
}

}  // namespace

BendingSet::BendingSet(const TriangleMesh& rest, double stiffness)
    : BendingSet(rest, Eigen::Vector3d::UnitX(), stiffness, stiffness) {}

BendingSet::BendingSet(const TriangleMesh& rest, const Eigen::Vector3d& warp, double warp_stiffness,
                       double weft_stiffness) {
  check_stiffness(warp_stiffness);
  check_stiffness(weft_stiffness);
  const Edges mesh_edges = edges(rest);
  std::vector<Hinge> hinges;
  for (std::size_t e = 0; e < mesh_edges.vertices.size(); ++e) {
    const auto [i, j] = mesh_edges.vertices[e];
    const auto [k, l] = mesh_edges.opposite[e];
    if (k < 0 || l < 0) continue;
    const Eigen::Vector3d xi = rest.vertices.col(i), xj = rest.vertices.col(j);
    const Eigen::Vector3d xk = rest.vertices.col(k), xl = rest.vertices.col(l);
    const double ik = cotangent(xj - xi, xk - xi), il = cotangent(xj - xi, xl - xi);
    const double jk = cotangent(xi - xj, xk - xj), jl = cotangent(xi - xj, xl - xj);
    const double areas = 0.5 * ((xj - xi).cross(xk - xi).norm() + (xj - xi).cross(xl - xi).norm());
    Hinge hinge;
    hinge.vertices = {i, j, k, l};
    hinge.weights = {jk + jl, ik + il, -ik - jk, -il - jl};
    double stiffness = warp_stiffness;
    if (warp_stiffness != weft_stiffness) {
      const double along =
          0.5 * (squared_cosine(warp, xj - xi, xk - xi) + squared_cosine(warp, xj - xi, xl - xi));
      stiffness = std::pow(warp_stiffness, 1.0 - along) * std::pow(weft_stiffness, along);
    }
    hinge.stiffness = stiffness / areas;
    hinges.push_back(hinge);
  }
  color(hinges, static_cast<int>(rest.vertices.cols()));
}

BendingSet::BendingSet(const GridOptions& grid, double warp_stiffness, double weft_stiffness) {
  check_stiffness(warp_stiffness);
  check_stiffness(weft_stiffness);
  const double a = grid.width / (grid.columns - 1), b = grid.height / (grid.rows - 1);
  const auto share = [](int index, int count) {
    return index == 0 || index + 1 == count ? 0.5 : 1.0;
  };
  std::vector<Hinge> hinges;
  // κ = (x₋ - 2 x + x₊)/a² over the area a b that a vertex stands for; a fourth vertex of weight 0.
  const auto add_line = [&](int i, int step, int beside, double stiffness) {
    hinges.push_back({{i - step, i, i + step, beside}, {1.0, -2.0, 1.0, 0.0}, stiffness});
  };
  const double twist = 2.0 * std::sqrt(warp_stiffness * weft_stiffness) / (a * b);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      const int i = r * grid.columns + c, up = grid.columns;
      if (c > 0 && c + 1 < grid.columns) {
        const double own = warp_stiffness * share(r, grid.rows) * b / (a * a * a);
        add_line(i, 1, r + 1 < grid.rows ? i + up : i - up, own);
      }
      if (r > 0 && r + 1 < grid.rows) {
        const double own = weft_stiffness * share(c, grid.columns) * a / (b * b * b);
        add_line(i, up, c + 1 < grid.columns ? i + 1 : i - 1, own);
      }
      if (c + 1 < grid.columns && r + 1 < grid.rows) {
        hinges.push_back({{i, i + up + 1, i + 1, i + up}, {1.0, 1.0, -1.0, -1.0}, twist});
      }
    }
  }
  color(hinges, grid.columns * grid.rows);
}

void BendingSet::color(const std::vector<Hinge>& hinges, int particles) {
  std::vector<int> vertices;
  for (const Hinge& hinge : hinges) {
    vertices.insert(vertices.end(), hinge.vertices.begin(), hinge.vertices.end());
  }
  const Coloring coloring = color_elements(vertices, 4, particles);
  begins_ = coloring.begins;
  for (int e : coloring.order) hinges_.push_back(hinges[static_cast<std::size_t>(e)]);
  multipliers_.setZero(3, size());
}

Eigen::Vector3d BendingSet::curvature(const Hinge& hinge, const Positions& x) {
  const auto& v = hinge.vertices;
  const auto& w = hinge.weights;
  return w[0] * x.col(v[0]) + w[1] * x.col(v[1]) + w[2] * x.col(v[2]) + w[3] * x.col(v[3]);
}

double BendingSet::energy(const Positions& x) const {
  return parallel_sum(0, size(), kGrain, [&](int e) {
    const Hinge& hinge = hinges_[static_cast<std::size_t>(e)];
    return 0.5 * hinge.stiffness * curvature(hinge, x).squaredNorm();
  });
}

void BendingSet::add_forces(const Positions& x, Forces& f) const {
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int e = begin; e < end; ++e) {
        const Hinge& hinge = hinges_[static_cast<std::size_t>(e)];
        const Eigen::Vector3d force = -hinge.stiffness * curvature(hinge, x);
        for (std::size_t k = 0; k < 4; ++k) f.col(hinge.vertices[k]) += hinge.weights[k] * force;
      }
    });
  }
}

void BendingSet::add_to_system(SystemMatrix& a) const {
  for (const Hinge& hinge : hinges_) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double entry = hinge.stiffness * hinge.weights[r] * hinge.weights[c];
        if (entry != 0.0) a.add(hinge.vertices[r], hinge.vertices[c], entry);
      }
    }
  }
}

void BendingSet::add_stiffness(const Positions&, Definiteness, StiffnessMatrix& k) const {
  for (const Hinge& hinge : hinges_) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double entry = hinge.stiffness * hinge.weights[r] * hinge.weights[c];
        if (entry == 0.0) continue;  // of a line's fourth vertex
        k.add(hinge.vertices[r], hinge.vertices[c], entry * Eigen::Matrix3d::Identity());
      }
    }
  }
}

void BendingSet::add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const {
  std::vector<StrainMeasure> strains;
  for (const Hinge& hinge : hinges_) {
    StrainMeasure strain;
    strain.kind = StrainMeasure::kCurvature;
    strain.count = 4;
    strain.particles = hinge.vertices;
    strain.first = hinge.weights;
    // The fourth vertex of a line lies beside it.
    if (hinge.weights[3] == 0.0) strain.normal = {0, 2, 1, 3};
    strain.stiffness = hinge.stiffness;
    strains.push_back(strain);
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

void BendingSet::reset_multipliers() { multipliers_.setZero(); }

void BendingSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const double dt2 = dt * dt;
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain, [&](int begin, int end) {
      for (int e = begin; e < end; ++e) {
        const Hinge& hinge = hinges_[static_cast<std::size_t>(e)];
        double mobility = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
          mobility += hinge.weights[k] * hinge.weights[k] * inverse_mass[hinge.vertices[k]];
        }
        // The spring's formula with the vector constraint C = sum K x, C = 0 at rest.
        const double k = hinge.stiffness;
        const Eigen::Vector3d delta =
            -(k * curvature(hinge, x) + multipliers_.col(e)) / (k * dt2 * mobility + 1.0);
        multipliers_.col(e) += delta;
        for (std::size_t v = 0; v < 4; ++v) {
          const int i = hinge.vertices[v];
          x.col(i) += dt2 * inverse_mass[i] * hinge.weights[v] * delta;
        }
      }
    });
  }
}

}  // namespace pliant
