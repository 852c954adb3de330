#include "pliant/models/reduced/reduced_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/models/reduced/project_potential.h"
#include "support/expect_refusal.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {
namespace {

struct Reduction {
  explicit Reduction(const StvkBody& body, int k, int rank)
      : stiffness(body.rest_stiffness()),
        mass(body.consistent_mass()),
        modes(linear_modes(body, stiffness, mass, k)),
        response(stiffness, mass, modes.rigid),
        derivatives(modal_derivatives(body, modes, response, go_on)),
        basis(mass_pca(modes, derivatives, stiffness, mass, rank)) {}
  Eigen::SparseMatrix<double> stiffness, mass;
  LinearModes modes;
  StaticResponse response;
  Eigen::MatrixXd derivatives;
  ReducedBasis basis;
};

StvkBody beam() { return cantilever({{1.0, 0.1, 0.2}, {12, 2, 3}}, {1e6, 0.3, 1000.0}); }
StvkBody free_block() {
  return StvkBody(make_block({{0.6, 0.2, 0.3}, {6, 2, 3}}), {1e6, 0.3, 1000.0}, {}, "block");
}

void expect_reduced(const Reduction& reduction, int rank) {
  const Eigen::MatrixXd& u = reduction.basis.u;
  ASSERT_EQ(u.cols(), rank);
  const Eigen::MatrixXd m = u.transpose() * (reduction.mass * u);
  EXPECT_LT((m - Eigen::MatrixXd::Identity(rank, rank)).cwiseAbs().maxCoeff(), 1e-12);
  Eigen::MatrixXd k = u.transpose() * (reduction.stiffness * u);
  EXPECT_LT((k.diagonal() - reduction.basis.lambda).cwiseAbs().maxCoeff(),
            1e-12 * reduction.basis.lambda.maxCoeff());
  k.diagonal().setZero();
  EXPECT_LT(k.cwiseAbs().maxCoeff(), 1e-12 * reduction.basis.lambda.maxCoeff());
}

TEST(ReducedBasis, IsMassOrthonormalAndDiagonalisesTheStiffness) {
  expect_reduced(Reduction(beam(), 8, 20), 20);
  expect_reduced(Reduction(free_block(), 8, 20), 20);
}

TEST(ReducedBasis, ModesSolveTheirEquation) {
  const Reduction r(beam(), 8, 20);
  for (int i = 0; i < 8; ++i) {
    const Eigen::VectorXd psi = r.modes.shapes.col(i);
    const Eigen::VectorXd inertia = r.modes.lambda[i] * (r.mass * psi);
    EXPECT_LT((r.stiffness * psi - inertia).norm(), 1e-9 * inertia.norm()) << "mode " << i;
  }
  EXPECT_EQ(r.modes.rigid.cols(), 0);
  for (const auto psi : r.modes.shapes.colwise()) {
    EXPECT_GT(psi.maxCoeff(), -psi.minCoeff());  // the same sign on every machine
  }
}

TEST(ReducedBasis, AFreeBodysModesAreNoRigidMotions) {
  const Reduction r(free_block(), 8, 20);
  ASSERT_EQ(r.modes.rigid.cols(), 6);
  EXPECT_GT(r.modes.lambda[0], 1.0);
  EXPECT_LT((r.modes.rigid.transpose() * (r.mass * r.modes.shapes)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((r.stiffness * r.modes.rigid).norm(), 1e-10 * r.stiffness.norm());
  EXPECT_LT((r.modes.rigid.transpose() * (r.mass * r.basis.u)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ReducedBasis, RigidMotionsAreThoseThatFixedVerticesAllow) {
  const TetrahedralMesh mesh = make_block({{1, 1, 1}, {1, 1, 1}});
  const auto count = [&](const std::vector<int>& fixed) {
    const StvkBody body(mesh, {}, fixed, "block");
    return rigid_motions(body, body.consistent_mass()).cols();
  };
  EXPECT_EQ(count({}), 6);
  EXPECT_EQ(count({0}), 3);
  EXPECT_EQ(count({0, 1}), 1);
  EXPECT_EQ(count({0, 1, 2}), 0);
}

TEST(ReducedBasis, RigidMotionsAreMassOrthonormal) {
  // Vertices of a block have different masses, so that turns about their mean carry momentum too,
  // and those about a fixed corner share their axes' products of inertia.
  const TetrahedralMesh mesh = make_block({{0.6, 0.2, 0.3}, {2, 1, 1}});
  for (const std::vector<int>& fixed : {std::vector<int>{}, std::vector<int>{0}}) {
    const StvkBody body(mesh, {1e6, 0.3, 1000.0}, fixed, "block");
    const Eigen::SparseMatrix<double> mass = body.consistent_mass();
    const Eigen::MatrixXd rigid = rigid_motions(body, mass);
    const Eigen::MatrixXd products = rigid.transpose() * (mass * rigid);
    const auto unit = Eigen::MatrixXd::Identity(rigid.cols(), rigid.cols());
    EXPECT_LT((products - unit).cwiseAbs().maxCoeff(), 1e-12) << fixed.size() << " fixed";
  }
}

TEST(ReducedBasis, ModalDerivativesAreTheSecondOrderOfTheStaticResponse) {
  // K u + ½ H[u, u] = K (p₀ Ψ₀ + p₁ Ψ₁) is solved by u = Σ pᵢ Ψᵢ + ½ Σ pᵢ pⱼ Φᵢⱼ up to p³.
  const StvkBody body = beam();
  const Reduction r(body, 2, 3);
  const auto residual = [&](double p) {
    const Eigen::VectorXd linear = p * (r.modes.shapes.col(0) - 0.5 * r.modes.shapes.col(1));
    const Eigen::VectorXd second =
        0.5 * p * p * (r.derivatives.col(0) - r.derivatives.col(1) + 0.25 * r.derivatives.col(2));
    return (body.forces(linear + second) - r.stiffness * linear).norm();
  };
  // Of third order: halving the amplitude leaves an eighth.
  EXPECT_NEAR(residual(1e-3) / residual(5e-4), 8.0, 0.1);
}

TEST(ReducedBasis, RefusesMoreThanThereIs) {
  expect_refusal([] { Reduction(beam(), 2, 6); }, {"rank is 6", "from 1 to 5"});
  expect_refusal([] { Reduction(small_cantilever(), 30, 6); }, {"30 modes", "from 1 to"});
}

TEST(ReducedBasis, BeamFrequenciesConvergeToEulerBernoullis) {
  // Slender, Poisson's ratio 0: ωₙ = βₙ² √(E I/(ρ A)) / L², β = 1.8751, 4.6941. Linear tetrahedra
  // are too stiff in bending, by an amount that falls with the square of their size.
  const double length = 1.0, height = 0.06, width = 0.08, young = 1e7, density = 1000.0;
  const auto lowest = [&](int refinement) {
    const StvkBody body =
        cantilever({{length, width, height}, {16 * refinement, refinement, 2 * refinement}},
                   {young, 0.0, density});
    return std::sqrt(
        linear_modes(body, body.rest_stiffness(), body.consistent_mass(), 1).lambda[0]);
  };
  const double exact = std::pow(1.8751040687, 2) *
                       std::sqrt(young * height * height / (12.0 * density)) / (length * length);
  const double coarse = lowest(2) / exact - 1.0, fine = lowest(4) / exact - 1.0;
  EXPECT_GT(coarse, fine);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
  // What extrapolation leaves is the theory's own, shear and rotary inertia of order (h/L)², and
  // the next term of the mesh's error, of the square of the fine one.
  EXPECT_NEAR((4.0 * fine - coarse) / 3.0, 0.0, std::pow(height / length, 2) + std::pow(fine, 2));
}

}  // namespace
}  // namespace pliant
