#include "pliant/elements/bending_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/core/parallel.h"
#include "pliant/elements/coloring.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 512;

/// Cotangent of the angle between `a` and `b`, and twice their triangle's area.
double cotangent(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.dot(b) / a.cross(b).norm();
}

}  // namespace

BendingSet::BendingSet(const TriangleMesh& rest, double stiffness) {
  if (!(std::isfinite(stiffness) && stiffness > 0.0)) {
    throw InputError(fmt::format("bending stiffness is {} N m, but must be positive", stiffness));
  }
  const Edges mesh_edges = edges(rest);
  std::vector<Hinge> hinges;
  std::vector<int> vertices;
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
    hinge.stiffness = stiffness / areas;
    hinges.push_back(hinge);
    vertices.insert(vertices.end(), hinge.vertices.begin(), hinge.vertices.end());
  }
  const Coloring coloring = color_elements(vertices, 4, static_cast<int>(rest.vertices.cols()));
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
  double sum = 0.0;
  for (const Hinge& hinge : hinges_)
    sum += 0.5 * hinge.stiffness * curvature(hinge, x).squaredNorm();
  return sum;
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
        a.add(hinge.vertices[r], hinge.vertices[c],
              hinge.stiffness * hinge.weights[r] * hinge.weights[c]);
      }
    }
  }
}

void BendingSet::add_stiffness(const Positions&, Definiteness, StiffnessMatrix& k) const {
  for (const Hinge& hinge : hinges_) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double entry = hinge.stiffness * hinge.weights[r] * hinge.weights[c];
        k.add(hinge.vertices[r], hinge.vertices[c], entry * Eigen::Matrix3d::Identity());
      }
    }
  }
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
