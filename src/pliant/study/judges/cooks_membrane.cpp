// Cook's membrane: a panel that tapers from 44 to 16 over a length of 48, clamped at its left side
// and sheared at the other by a force of 1 over a depth of 1; how far the middle of that side
// rises.
#include <cmath>

#include "pliant/study/judges/body_case.h"
#include "pliant/study/judges/judge.h"

namespace pliant {
namespace cooks_membrane {
namespace {

/// The rise with `cells` along each side, in plane strain or, with both faces free, plane stress.
double membrane_rise(int cells, const ElasticMaterial& material, bool is_plane_strain) {
  TetrahedralMesh mesh = make_block({{1.0, 1.0, 1.0}, {cells, cells, 1}});
  const Eigen::Matrix3Xd square = mesh.vertices.array() + 0.5;
  for (Eigen::Index i = 0; i < square.cols(); ++i) {
    const double along = square(0, i), across = square(1, i);
    mesh.vertices.col(i) << 48.0 * along, 44.0 * along + across * (44.0 - 28.0 * along),
        square(2, i);
  }
  BodyCase membrane(std::move(mesh), material, 1e6);
  // So small that the answer is linear.
  constexpr double kForce = 1e-3;
  Eigen::VectorXd share = Eigen::VectorXd::Zero(square.cols());
  int middle = 0;
  for (int i = 0; i < square.cols(); ++i) {
    if (square(0, i) < 1e-9) membrane.fix(i);
    if (square(0, i) < 1.0 - 1e-9) continue;
    if (std::abs(square(1, i) - 0.5) < 1e-9) middle = i;
    share[i] = square(1, i) < 1e-9 || square(1, i) > 1.0 - 1e-9 ? 0.5 : 1.0;
  }
  Forces loads = Forces::Zero(3, square.cols());
  loads.row(1) = kForce * share.transpose() / share.sum();
  membrane.set_loads(loads);
  if (is_plane_strain) membrane.hold_plane(material.young);
  membrane.start();
  membrane.load(1);
  return (membrane.particles().x(1, middle) - membrane.rest()(1, middle)) / kForce;
}

std::vector<JudgedFigure> judge_cooks_membrane(const JudgeOptions&) {
  const ElasticMaterial stress{1.0, 1.0 / 3.0, 1.0};
  // λ = 7500, μ = 0.375.
  constexpr double kLambda = 7500.0, kMu = 0.375;
  const ElasticMaterial strain{kMu * (3.0 * kLambda + 2.0 * kMu) / (kLambda + kMu),
                               0.5 * kLambda / (kLambda + kMu), 1.0};
  constexpr int kCells = 32;
  return {{"rise, plane stress, Poisson 1/3", "m", 23.97, membrane_rise(kCells, stress, false),
           membrane_rise(kCells / 2, stress, false)},
          {"rise, plane strain, Poisson 0.499975", "m", 16.442, membrane_rise(kCells, strain, true),
           membrane_rise(kCells / 2, strain, true)}};
}

}  // namespace
}  // namespace cooks_membrane

Judge cooks_membrane_judge() {
  return {
      "cooks_membrane",
      "Cook 1974 (J. Struct. Div. ASCE 100); converged rises: 23.97 in plane stress (Krysl, "
      "FinEtools), 16.442 near incompressibility (Nakshatrala, Masud and Hjelmstad 2008; 16.433 "
      "in Krysl's)",
      "E = 1 and Poisson 1/3; mu = 0.375 and lambda = 7500; 32 x 32 x 1 cells",
      kComputed,
      true,
      cooks_membrane::judge_cooks_membrane};
}

}  // namespace pliant
