#include "pliant/models/reduced/linear_modes.h"

#include <fmt/format.h>
#ifdef PLIANT_SPECTRA
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#endif

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "pliant/math/error.h"
#include "pliant/math/symmetric_eigen.h"

namespace pliant {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Eigenpairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

#ifdef PLIANT_SPECTRA

/// (K - σ M)⁻¹, as Spectra asks for it.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(const Sparse& stiffness, const Sparse& mass) : stiffness_(stiffness), mass_(mass) {}
  Eigen::Index rows() const { return stiffness_.rows(); }
  Eigen::Index cols() const { return stiffness_.cols(); }
  void set_shift(const double& sigma) { factor_.emplace(stiffness_ - sigma * mass_); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd>(y, rows()) =
        factor_->solve(Eigen::Map<const Eigen::VectorXd>(x, rows()));
  }

 private:
  const Sparse& stiffness_;
  const Sparse& mass_;
  std::optional<ElasticFactor> factor_;
};

/// The `wanted` lowest of K ψ = λ M ψ, in rising order; none when they do not converge.
std::optional<Eigenpairs> lowest_eigenpairs(const Sparse& stiffness, const Sparse& mass,
                                            int wanted) {
  ShiftInvert shift_invert(stiffness, mass);
  Spectra::SparseSymMatProd<double> product(mass);
  const int subspace = std::min(static_cast<int>(stiffness.rows()), std::max(2 * wanted + 10, 30));
  Spectra::SymGEigsShiftSolver<ShiftInvert, Spectra::SparseSymMatProd<double>,
                               Spectra::GEigsMode::ShiftInvert>
      lanczos(shift_invert, product, wanted, subspace, regularising_shift(stiffness, mass));
  lanczos.init();
  lanczos.compute(Spectra::SortRule::LargestMagn, 1000, 1e-12, Spectra::SortRule::SmallestAlge);
  if (lanczos.info() != Spectra::CompInfo::Successful) return std::nullopt;
  return Eigenpairs{lanczos.eigenvalues(), lanczos.eigenvectors()};
}

#else

std::optional<Eigenpairs> lowest_eigenpairs(const Sparse&, const Sparse&, int) {
  throw InputError(
      "modes need Spectra 1.0 or newer, which this build did not find: install it (Debian 12: "
      "libspectra-dev) and configure again");
}

#endif

/// Six motions of all vertices, 3n x 6: translations, and rotations about the centre in units of
/// the body's size.
Eigen::MatrixXd motions_of_all(const TetrahedralMesh& mesh) {
  const Eigen::Vector3d centre = mesh.vertices.rowwise().mean();
  const Eigen::Matrix3Xd arms = mesh.vertices.colwise() - centre;
  const double size = arms.colwise().norm().maxCoeff();
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * arms.cols(), 6);
  for (Eigen::Index v = 0; v < arms.cols(); ++v) {
    for (int k = 0; k < 3; ++k) {
      motions(3 * v + k, k) = 1.0;
      motions.block<3, 1>(3 * v, 3 + k) = Eigen::Vector3d::Unit(k).cross(arms.col(v)) / size;
    }
  }
  return motions;
}

/// The combinations of motions that leave fixed vertices where they are: 6 x (0 to 6).
Eigen::MatrixXd allowed_combinations(const StvkBody& body, const Eigen::MatrixXd& motions) {
  Eigen::MatrixXd at_fixed = Eigen::MatrixXd::Zero(6, 6);  // squared
  bool none = true;
  for (int v = 0; v < static_cast<int>(body.mesh().vertices.cols()); ++v) {
    if (body.index(v) >= 0) continue;
    const auto rows = motions.middleRows(3 * v, 3);
    at_fixed += rows.transpose() * rows;
    none = false;
  }
  if (none) return Eigen::MatrixXd::Identity(6, 6);
  const SymmetricEigen eigen = symmetric_eigen(at_fixed);
  // Of eigenvalues, which are squares: 1e-6 of the body's size.
  constexpr double kTolerance = 1e-12;
  Eigen::Index free = 0;
  while (free < 6 && eigen.values[free] <= kTolerance * eigen.values[5]) ++free;
  return eigen.vectors.leftCols(free);
}

void make_largest_positive(Eigen::MatrixXd& columns) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    Eigen::Index row = 0;
    columns.col(c).cwiseAbs().maxCoeff(&row);
    if (columns(row, c) < 0.0) columns.col(c) *= -1.0;
  }
}

}  // namespace

double regularising_shift(const Sparse& stiffness, const Sparse& mass) {
  constexpr double kShare = 1e-10;
  return -kShare * (stiffness.diagonal().array() / mass.diagonal().array()).maxCoeff();
}

Eigen::MatrixXd rigid_motions(const StvkBody& body, const Sparse& mass) {
  const Eigen::MatrixXd motions = motions_of_all(body.mesh());
  const Eigen::MatrixXd all = motions * allowed_combinations(body, motions);
  Eigen::MatrixXd rigid(body.size(), all.cols());
  for (int v = 0; v < static_cast<int>(body.mesh().vertices.cols()); ++v) {
    if (body.index(v) >= 0) rigid.middleRows(body.index(v), 3) = all.middleRows(3 * v, 3);
  }
  for (int pass = 0; pass < 2; ++pass) {  // the second takes off what round-off left
    for (Eigen::Index c = 0; c < rigid.cols(); ++c) {
      for (Eigen::Index b = 0; b < c; ++b) {
        rigid.col(c) -= rigid.col(b).dot(mass * rigid.col(c)) * rigid.col(b);
      }
      rigid.col(c) /= std::sqrt(rigid.col(c).dot(mass * rigid.col(c)));
    }
  }
  return rigid;
}

LinearModes linear_modes(const StvkBody& body, const Sparse& stiffness, const Sparse& mass,
                         int count) {
  LinearModes modes;
  modes.rigid = rigid_motions(body, mass);
  const int rigid = static_cast<int>(modes.rigid.cols());
  const int wanted = count + rigid;
  if (count < 1 || wanted >= body.size()) {
    throw InputError(fmt::format("{} modes are wanted, but must be from 1 to {} for this body",
                                 count, body.size() - rigid - 1));
  }
  const std::optional<Eigenpairs> lowest = lowest_eigenpairs(stiffness, mass, wanted);
  if (!lowest) {
    throw InputError(fmt::format(
        "the {} lowest modes did not converge: is a part of the body thin or loose?", count));
  }
  modes.shapes = lowest->vectors.rightCols(count);
  modes.lambda = lowest->values.tail(count);
  make_largest_positive(modes.shapes);
  return modes;
}

StaticResponse::StaticResponse(const Sparse& stiffness, const Sparse& mass,
                               const Eigen::MatrixXd& rigid)
    : stiffness_(stiffness),
      rigid_(rigid),
      rigid_momenta_(mass * rigid),
      factor_(stiffness - (rigid.cols() > 0 ? regularising_shift(stiffness, mass) : 0.0) * mass) {}

Eigen::VectorXd StaticResponse::solve(const Eigen::VectorXd& load) const {
  const Eigen::VectorXd balanced = load - rigid_momenta_ * (rigid_.transpose() * load);
  Eigen::VectorXd x = factor_.solve(balanced);
  // Refinement takes off what the shift and round-off left, until that is no more than round-off.
  constexpr double kRoundOff = 1e-13;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::VectorXd residual = balanced - stiffness_ * x;
    residual -= rigid_momenta_ * (rigid_.transpose() * residual);
    const Eigen::VectorXd change = factor_.solve(residual);
    x += change;
    x -= rigid_ * (rigid_momenta_.transpose() * x);
    if (change.norm() <= kRoundOff * x.norm()) break;
  }
  return x;
}

}  // namespace pliant
