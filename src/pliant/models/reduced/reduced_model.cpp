#include "pliant/models/reduced/reduced_model.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Shapes and rigid motions side by side, squared frequencies (0 of rigid ones) below them.
Eigen::MatrixXd pack(const LinearModes& modes) {
  const Eigen::Index size = modes.shapes.rows(), count = modes.shapes.cols();
  Eigen::MatrixXd packed = Eigen::MatrixXd::Zero(size + 1, count + modes.rigid.cols());
  packed.topLeftCorner(size, count) = modes.shapes;
  packed.topRightCorner(size, modes.rigid.cols()) = modes.rigid;
  packed.bottomLeftCorner(1, count) = modes.lambda.transpose();
  return packed;
}

LinearModes unpack(const Eigen::MatrixXd& packed, int count) {
  const Eigen::Index size = packed.rows() - 1;
  return {packed.topLeftCorner(size, count), packed.bottomLeftCorner(1, count).transpose(),
          packed.topRightCorner(size, packed.cols() - count)};
}

}  // namespace

Eigen::Matrix3Xd ReducedModel::positions(const Eigen::VectorXd& q) const {
  const Eigen::VectorXd u = basis * q;
  return mesh.vertices + Eigen::Map<const Eigen::Matrix3Xd>(u.data(), 3, mesh.vertices.cols());
}

Eigen::VectorXd ReducedModel::reduced_force(const Eigen::Matrix3Xd& forces) const {
  return basis.transpose() * Eigen::Map<const Eigen::VectorXd>(forces.data(), forces.size());
}

double ReducedModel::smallest_stretch(const Eigen::VectorXd& q) const {
  const Eigen::Matrix3Xd x = positions(q);
  const auto sides = [&](const Eigen::Matrix3Xd& from, Eigen::Index t) {
    Eigen::Matrix3d d;
    for (int k = 0; k < 3; ++k) {
      d.col(k) = from.col(mesh.tetrahedra(k + 1, t)) - from.col(mesh.tetrahedra(0, t));
    }
    return d;
  };
  double smallest = std::numeric_limits<double>::infinity();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  for (Eigen::Index t = 0; t < mesh.tetrahedra.cols(); ++t) {
    const Eigen::Matrix3d f = sides(x, t) * sides(mesh.vertices, t).inverse();
    eigen.compute(f.transpose() * f, Eigen::EigenvaluesOnly);
    smallest = std::min(smallest, std::sqrt(std::max(0.0, eigen.eigenvalues()[0])));
  }
  return smallest;
}

std::optional<ReducedModel> reduce(const StvkBody& body, const ReduceOptions& options,
                                   const std::string& name, const ReduceProgress& progress,
                                   const MatrixStore& store) {
  const int span = options.modes + options.modes * (options.modes + 1) / 2;
  const int max_rank = std::min({kMaxRank, span, body.size()});
  if (options.modes < 1 || options.rank < 1 || options.rank > max_rank) {
    throw InputError(fmt::format("{}: rank is {}, but must be from 1 to {} with {} modes", name,
                                 options.rank, max_rank, options.modes));
  }
  if (!progress(0.0, 1.0, "linear modes")) return std::nullopt;
  const auto stiffness = body.rest_stiffness();
  const auto mass =
      options.mass == MassMatrix::kConsistent ? body.consistent_mass() : body.lumped_mass();
  const auto stored = [&](const char* what, const std::function<Eigen::MatrixXd()>& make) {
    return store ? store(what, make) : make();
  };
  const LinearModes modes = unpack(
      stored("modes", [&] { return pack(linear_modes(body, stiffness, mass, options.modes)); }),
      options.modes);
  const StaticResponse response(stiffness, mass, modes.rigid);
  const Eigen::MatrixXd derivatives =
      stored("derivatives", [&] { return modal_derivatives(body, modes, response, progress); });
  if (derivatives.size() == 0) return std::nullopt;
  const ReducedBasis basis = mass_pca(modes, derivatives, stiffness, mass, options.rank);
  std::optional<QuarticPotential> potential = project_potential(body, basis, progress);
  if (!potential) return std::nullopt;
  ReducedModel model{name, body.material(), options.modes, body.mesh(), {}, {}, {}};
  for (int v = 0; v < static_cast<int>(model.mesh.vertices.cols()); ++v) {
    model.fixed.push_back(body.index(v) < 0);
  }
  model.basis = body.expand(basis.u);
  model.potential = std::move(*potential);
  return model;
}

}  // namespace pliant
