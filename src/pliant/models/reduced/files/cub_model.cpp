#include "pliant/models/reduced/files/cub_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"
#include "pliant/models/reduced/files/cub_file.h"
#include "pliant/models/reduced/stvk_body.h"

namespace pliant {
namespace {

constexpr double kSameMass = 1e-4;

/// Rows of the vertices that are not fixed.
Eigen::MatrixXd free_rows(const ReducedModel& model, const StvkBody& body) {
  Eigen::MatrixXd free(body.size(), model.basis.cols());
  for (int v = 0; v < static_cast<int>(model.mesh.vertices.cols()); ++v) {
    if (body.index(v) >= 0) free.middleRows<3>(body.index(v)) = model.basis.middleRows<3>(3 * v);
  }
  return free;
}

StvkBody full_body(const ReducedModel& model) {
  std::vector<int> fixed;
  for (std::size_t v = 0; v < model.fixed.size(); ++v) {
    if (model.fixed[v]) fixed.push_back(static_cast<int>(v));
  }
  return StvkBody(model.mesh, model.material, fixed, model.name);
}

}  // namespace

Eigen::MatrixXd read_vega_matrix(const std::string& path) {
  const std::string bytes = read_bytes(path);
  std::int32_t sizes[2];
  if (bytes.size() < sizeof sizes) {
    throw InputError(fmt::format("{}: too few bytes for a matrix's sizes", path));
  }
  std::memcpy(sizes, bytes.data(), sizeof sizes);
  const double count = static_cast<double>(sizes[0]) * sizes[1];
  if (sizes[0] < 1 || sizes[1] < 1 ||
      static_cast<double>(bytes.size()) != sizeof sizes + sizeof(double) * count) {
    throw InputError(fmt::format("{}: {} bytes, but a matrix of {} x {} has {:.0f}", path,
                                 bytes.size(), sizes[0], sizes[1],
                                 sizeof sizes + sizeof(double) * std::max(0.0, count)));
  }
  Eigen::MatrixXd matrix(sizes[0], sizes[1]);
  std::memcpy(matrix.data(), bytes.data() + sizeof sizes, bytes.size() - sizeof sizes);
  if (!matrix.allFinite()) throw InputError(fmt::format("{}: a number is not finite", path));
  return matrix;
}

ReducedModel make_cub_model(const std::string& cub, const std::string& basis,
                            const TetrahedralMesh& mesh, const ElasticMaterial& material,
                            const std::string& name) {
  CubPotential read = read_cub(cub);
  ReducedModel model{name, material, read.potential.rank(), mesh, {}, read_vega_matrix(basis), {}};
  const Eigen::Index rows = 3 * mesh.vertices.cols(), rank = read.potential.rank();
  if (model.basis.rows() != rows || model.basis.cols() != rank) {
    throw InputError(fmt::format(
        "{}: {} x {} numbers, but the mesh has {} vertices and {} has rank {}: {} x {}", basis,
        model.basis.rows(), model.basis.cols(), mesh.vertices.cols(), cub, rank, rows, rank));
  }
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    model.fixed.push_back(model.basis.middleRows<3>(3 * v).isZero(0.0));
  }
  const StvkBody body = full_body(model);
  const Eigen::MatrixXd u = free_rows(model, body);
  const auto distance = [&](const Eigen::SparseMatrix<double>& mass) {
    return (u.transpose() * (mass * u) - Eigen::MatrixXd::Identity(rank, rank))
        .cwiseAbs()
        .maxCoeff();
  };
  const double off = std::min(distance(body.consistent_mass()), distance(body.lumped_mass()));
  if (!(off <= kSameMass)) {
    throw InputError(fmt::format(
        "{}: with density {:g} kg/m^3 the basis is not mass-orthonormal: U^T M U differs from 1 by "
        "{:.2g}, at most {:g} is allowed",
        basis, material.density, off, kSameMass));
  }
  model.basis = (model.basis * read.rotation).eval();
  model.potential = std::move(read.potential);
  return model;
}

double force_difference(const ReducedModel& model) {
  const StvkBody body = full_body(model);
  const Eigen::MatrixXd u = free_rows(model, body);
  const Eigen::Vector3d size =
      model.mesh.vertices.rowwise().maxCoeff() - model.mesh.vertices.rowwise().minCoeff();
  QuarticPotential::Workspace space;
  Eigen::VectorXd force;
  double worst = 0.0;
  for (int i = 0; i < model.rank(); ++i) {
    // Coordinates one after the other, the next one along with each.
    Eigen::VectorXd q = Eigen::VectorXd::Unit(model.rank(), i);
    q[(i + 1) % model.rank()] += 0.5;
    q *= 0.1 * size.norm() / (u * q).cwiseAbs().maxCoeff();
    const Eigen::VectorXd expected = u.transpose() * body.forces(u * q);
    model.potential.evaluate(q, force, space);
    worst = std::max(worst, (force - expected).norm() / expected.norm());
  }
  return worst;
}

}  // namespace pliant
