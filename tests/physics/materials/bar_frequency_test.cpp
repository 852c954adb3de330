// Free vibration of a bar of tetrahedra with lumped masses against the wave equation.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <utility>

#include "support/solvers/statics.h"
#include "support/worlds/solids.h"

namespace pliant::bar_frequency_test {
namespace {

constexpr double kLength = 1.0, kYoung = 1e6, kDensity = 1000.0;

/// Lowest frequency [rad/s] of a bar fixed at one end that moves along its axis only.
double lowest_frequency(int cells) {
  const TetrahedralMesh mesh = make_block({{kLength, 0.1, 0.1}, {cells, 2, 2}});
  const int n = static_cast<int>(mesh.vertices.cols());
  const auto sets = make_solid(mesh, {kYoung, 0.0, kDensity});
  Statics statics(pointers(sets), n);
  const Eigen::VectorXd shares = vertex_volumes(mesh);
  std::vector<double> masses;
  for (int i = 0; i < n; ++i) {
    statics.fix(i, 1);
    statics.fix(i, 2);
    if (on_face(mesh, i, 0, -1)) {
      statics.fix(i, 0);
    } else {
      masses.push_back(kDensity * shares[i]);
    }
  }
  const Eigen::SparseMatrix<double> k = statics.stiffness(mesh.vertices, Definiteness::kExact);
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(k);
  const Eigen::Map<const Eigen::VectorXd> m(masses.data(), k.rows());
  Eigen::VectorXd u = Eigen::VectorXd::Ones(k.rows());
  for (int step = 0; step < 100; ++step) {
    const Eigen::VectorXd inertia = m.cwiseProduct(u);
    u = factor.solve(inertia).normalized();
  }
  return std::sqrt(u.dot(k * u) / u.dot(m.cwiseProduct(u)));
}

TEST(BarFrequency, IsWhatLinearTetrahedraGive) {
  // ω = π/(2 L) √(E/ρ) for Poisson's ratio 0. Linear elements with lumped masses swing as a chain
  // of points at distances Δ does, ω = 2 c/Δ sin(π Δ/(4 L)), or slower where neighbours of
  // different mass make better use of the freedom.
  const double c = std::sqrt(kYoung / kDensity);
  const double exact = M_PI / (2.0 * kLength) * c;
  const auto chain = [&](int cells) { return 2.0 * c * cells * std::sin(M_PI / (4.0 * cells)); };
  const double coarse = lowest_frequency(10), fine = lowest_frequency(20);
  for (const auto& [measured, theory] :
       {std::pair(coarse, chain(10)), std::pair(fine, chain(20))}) {
    EXPECT_LE(measured, theory * (1.0 + 1e-12));
    EXPECT_NEAR(measured / theory, 1.0, 2e-4);
  }
  EXPECT_LT(std::abs(fine - exact), std::abs(coarse - exact) / 3.0);
}

}  // namespace
}  // namespace pliant::bar_frequency_test
