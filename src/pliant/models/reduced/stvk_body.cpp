#include "pliant/models/reduced/stvk_body.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/elements/simplex.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& a) { return 0.5 * (a + a.transpose()); }

/// Green's strain of a displacement gradient G.
Eigen::Matrix3d green_strain(const Eigen::Matrix3d& g) {
  return symmetric(g) + 0.5 * g.transpose() * g;
}

void check(const ElasticMaterial& material, const std::string& where) {
  const auto refuse = [&](const char* field, double value, const char* range) {
    throw InputError(
        fmt::format("{}: material: {} is {}, but must be {}", where, field, value, range));
  };
  if (!(material.young > 0.0 && std::isfinite(material.young))) {
    refuse("young", material.young, "positive and finite [Pa]");
  }
  if (!(material.poisson > -1.0 && material.poisson < 0.5)) {
    refuse("poisson", material.poisson, "in (-1, 0.5)");
  }
  if (!(material.density > 0.0 && std::isfinite(material.density))) {
    refuse("density", material.density, "positive and finite [kg/m^3]");
  }
}

}  // namespace

StvkBody::StvkBody(TetrahedralMesh mesh, const ElasticMaterial& material,
                   const std::vector<int>& fixed, const std::string& where)
    : mesh_(std::move(mesh)), material_(material) {
  validate(mesh_, where);
  check(material, where);
  mu_ = material.young / (2.0 * (1.0 + material.poisson));
  lambda_ = material.young * material.poisson /
            ((1.0 + material.poisson) * (1.0 - 2.0 * material.poisson));
  const int n = static_cast<int>(mesh_.vertices.cols());
  index_.assign(static_cast<std::size_t>(n), 0);
  for (int vertex : fixed) {
    if (vertex < 0 || vertex >= n) {
      throw InputError(fmt::format("{}: fixed vertex {} is not in [0, {})", where, vertex, n));
    }
    index_[static_cast<std::size_t>(vertex)] = -1;
  }
  for (int& index : index_) {
    if (index < 0) continue;
    index = size_;
    size_ += 3;
  }
  if (size_ == 0) throw InputError(where + ": every vertex is fixed: leave some free");
  volumes_ = volumes(mesh_);
  shapes_.reserve(static_cast<std::size_t>(volumes_.size()));
  for (Eigen::Index t = 0; t < volumes_.size(); ++t) {
    Eigen::Matrix3d sides;
    for (int k = 0; k < 3; ++k) {
      sides.col(k) = mesh_.vertices.col(mesh_.tetrahedra(k + 1, t)) -
                     mesh_.vertices.col(mesh_.tetrahedra(0, t));
    }
    shapes_.push_back(shape_gradients<3>(sides));
  }
}

Eigen::MatrixXd StvkBody::expand(const Eigen::MatrixXd& free) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * mesh_.vertices.cols(), free.cols());
  for (int v = 0; v < static_cast<int>(mesh_.vertices.cols()); ++v) {
    if (index(v) >= 0) all.middleRows(3 * v, 3) = free.middleRows(index(v), 3);
  }
  return all;
}

Eigen::Matrix3d StvkBody::gradient(int t, const Eigen::VectorXd& u) const {
  Eigen::Matrix3d g = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 4; ++a) {
    const int i = index(mesh_.tetrahedra(a, t));
    if (i >= 0) {
      g += u.segment<3>(i) * shapes_[static_cast<std::size_t>(t)].col(a).transpose();
    }
  }
  return g;
}

Eigen::MatrixXd StvkBody::gradients(const Eigen::VectorXd& u) const {
  Eigen::MatrixXd all(3, 3 * volumes_.size());
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    all.middleCols<3>(3 * t) = gradient(t, u);
  }
  return all;
}

Eigen::Matrix3d StvkBody::stress(const Eigen::Matrix3d& strain) const {
  return 2.0 * mu_ * strain + lambda_ * strain.trace() * Eigen::Matrix3d::Identity();
}

void StvkBody::scatter(int t, const Eigen::Matrix3d& p, Eigen::VectorXd& r) const {
  for (int a = 0; a < 4; ++a) {
    const int i = index(mesh_.tetrahedra(a, t));
    if (i < 0) continue;
    r.segment<3>(i) += volumes_[t] * (p * shapes_[static_cast<std::size_t>(t)].col(a));
  }
}

double StvkBody::energy(const Eigen::VectorXd& u) const {
  double sum = 0.0;
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    const Eigen::Matrix3d e = green_strain(gradient(t, u));
    sum += 0.5 * volumes_[t] * stress(e).cwiseProduct(e).sum();
  }
  return sum;
}

Eigen::VectorXd StvkBody::forces(const Eigen::VectorXd& u) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(size_);
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    const Eigen::Matrix3d g = gradient(t, u);
    // First Piola-Kirchhoff stress P = F S.
    scatter(t, (Eigen::Matrix3d::Identity() + g) * stress(green_strain(g)), r);
  }
  return r;
}

Eigen::VectorXd StvkBody::second_derivative(const Eigen::VectorXd& a,
                                            const Eigen::VectorXd& b) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(size_);
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    const Eigen::Matrix3d ga = gradient(t, a), gb = gradient(t, b);
    scatter(t,
            ga * stress(symmetric(gb)) + gb * stress(symmetric(ga)) +
                stress(symmetric(ga.transpose() * gb)),
            r);
  }
  return r;
}

Eigen::SparseMatrix<double> StvkBody::rest_stiffness() const {
  Triplets entries;
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    const auto& shape = shapes_[static_cast<std::size_t>(t)];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const int i = index(mesh_.tetrahedra(a, t)), j = index(mesh_.tetrahedra(b, t));
        if (i < 0 || j < 0) continue;
        // K_ab = v (λ gₐ g_bᵀ + μ g_b gₐᵀ + μ (gₐ·g_b) I)
        const Eigen::Vector3d ga = shape.col(a), gb = shape.col(b);
        const Eigen::Matrix3d k =
            volumes_[t] * (lambda_ * ga * gb.transpose() + mu_ * gb * ga.transpose() +
                           mu_ * ga.dot(gb) * Eigen::Matrix3d::Identity());
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) entries.emplace_back(i + r, j + c, k(r, c));
        }
      }
    }
  }
  Eigen::SparseMatrix<double> k(size_, size_);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

Eigen::SparseMatrix<double> StvkBody::consistent_mass() const {
  Triplets entries;
  for (int t = 0; t < static_cast<int>(volumes_.size()); ++t) {
    const double share = material_.density * volumes_[t] / 20.0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const int i = index(mesh_.tetrahedra(a, t)), j = index(mesh_.tetrahedra(b, t));
        if (i < 0 || j < 0) continue;
        for (int c = 0; c < 3; ++c) entries.emplace_back(i + c, j + c, a == b ? 2 * share : share);
      }
    }
  }
  Eigen::SparseMatrix<double> m(size_, size_);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

Eigen::SparseMatrix<double> StvkBody::lumped_mass() const {
  const Eigen::VectorXd shares = vertex_volumes(mesh_);
  Triplets entries;
  for (int v = 0; v < static_cast<int>(shares.size()); ++v) {
    for (int c = 0; index(v) >= 0 && c < 3; ++c) {
      entries.emplace_back(index(v) + c, index(v) + c, material_.density * shares[v]);
    }
  }
  Eigen::SparseMatrix<double> m(size_, size_);
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

}  // namespace pliant
