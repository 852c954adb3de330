#include "pliant/models/reduced/stvk_body.h"

#include <fmt/format.h>

#include <cmath>

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
                   const std::vector<int>& fixed, const std::string& where, bool averaged)
    : mesh_(std::move(mesh)), material_(material) {
  validate(mesh_, where);
  check(material, where);
  if (averaged && material.poisson < 0.0) {
    throw InputError(fmt::format(
        "{}: material: poisson is {}, but averaged strains need at least 0: take strain "
        "'tetrahedra'",
        where, material.poisson));
  }
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
  const double mu = material.young / (2.0 * (1.0 + material.poisson));
  const double lambda = material.young * material.poisson /
                        ((1.0 + material.poisson) * (1.0 - 2.0 * material.poisson));
  if (!averaged) {
    parts_ = tetrahedron_stencils(where, mesh_);
    lame_.assign(static_cast<std::size_t>(parts_.size()), {lambda, mu});
    return;
  }
  parts_ = edge_stencils(where, mesh_);
  lame_.assign(static_cast<std::size_t>(parts_.size()), {0.0, mu});
  std::vector<bool> pinned(static_cast<std::size_t>(n));
  for (int vertex : fixed) pinned[static_cast<std::size_t>(vertex)] = true;
  parts_.append(vertex_means(tetrahedron_stencils(where, mesh_), pinned));
  lame_.resize(static_cast<std::size_t>(parts_.size()), {lambda, 0.0});
}

Eigen::MatrixXd StvkBody::expand(const Eigen::MatrixXd& free) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * mesh_.vertices.cols(), free.cols());
  for (int v = 0; v < static_cast<int>(mesh_.vertices.cols()); ++v) {
    if (index(v) >= 0) all.middleRows(3 * v, 3) = free.middleRows(index(v), 3);
  }
  return all;
}

Eigen::Matrix3d StvkBody::gradient(int part, const Eigen::VectorXd& u) const {
  Eigen::Matrix3d g = Eigen::Matrix3d::Zero();
  for (int k = parts_.begin(part); k < parts_.end(part); ++k) {
    const int i = index(parts_.particle(k));
    if (i >= 0) g += u.segment<3>(i) * parts_.shape(k).transpose();
  }
  return g;
}

Eigen::MatrixXd StvkBody::gradients(const Eigen::VectorXd& u) const {
  Eigen::MatrixXd all(3, 3 * parts());
  for (int part = 0; part < parts(); ++part) all.middleCols<3>(3 * part) = gradient(part, u);
  return all;
}

Eigen::Matrix3d StvkBody::stress(int part, const Eigen::Matrix3d& strain) const {
  const auto& [lambda, mu] = lame(part);
  return 2.0 * mu * strain + lambda * strain.trace() * Eigen::Matrix3d::Identity();
}

void StvkBody::scatter(int part, const Eigen::Matrix3d& p, Eigen::VectorXd& r) const {
  for (int k = parts_.begin(part); k < parts_.end(part); ++k) {
    const int i = index(parts_.particle(k));
    if (i >= 0) r.segment<3>(i) += rest_volume(part) * (p * parts_.shape(k));
  }
}

double StvkBody::energy(const Eigen::VectorXd& u) const {
  double sum = 0.0;
  for (int part = 0; part < parts(); ++part) {
    const Eigen::Matrix3d e = green_strain(gradient(part, u));
    sum += 0.5 * rest_volume(part) * stress(part, e).cwiseProduct(e).sum();
  }
  return sum;
}

Eigen::VectorXd StvkBody::forces(const Eigen::VectorXd& u) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(size_);
  for (int part = 0; part < parts(); ++part) {
    const Eigen::Matrix3d g = gradient(part, u);
    // First Piola-Kirchhoff stress P = F S.
    scatter(part, (Eigen::Matrix3d::Identity() + g) * stress(part, green_strain(g)), r);
  }
  return r;
}

Eigen::VectorXd StvkBody::second_derivative(const Eigen::VectorXd& a,
                                            const Eigen::VectorXd& b) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(size_);
  for (int part = 0; part < parts(); ++part) {
    const Eigen::Matrix3d ga = gradient(part, a), gb = gradient(part, b);
    scatter(part,
            ga * stress(part, symmetric(gb)) + gb * stress(part, symmetric(ga)) +
                stress(part, symmetric(ga.transpose() * gb)),
            r);
  }
  return r;
}

Eigen::SparseMatrix<double> StvkBody::rest_stiffness() const {
  Triplets entries;
  for (int part = 0; part < parts(); ++part) {
    const auto& [lambda, mu] = lame(part);
    for (int a = parts_.begin(part); a < parts_.end(part); ++a) {
      for (int b = parts_.begin(part); b < parts_.end(part); ++b) {
        const int i = index(parts_.particle(a)), j = index(parts_.particle(b));
        if (i < 0 || j < 0) continue;
        // K_ab = v (λ gₐ g_bᵀ + μ g_b gₐᵀ + μ (gₐ·g_b) I)
        const Eigen::Vector3d &ga = parts_.shape(a), &gb = parts_.shape(b);
        const Eigen::Matrix3d k =
            rest_volume(part) * (lambda * ga * gb.transpose() + mu * gb * ga.transpose() +
                                 mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
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
