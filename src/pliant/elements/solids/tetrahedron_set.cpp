#include "pliant/elements/solids/tetrahedron_set.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/stencil_set.h"
#include "pliant/math/error.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {

template class SimplexSet<CorotatedLaw>;

namespace {

/// Calls body(k, R) with the rotation nearest to each G.
template <class Body>
void for_rotations(const Eigen::Matrix3d* g, int count, const Body& body) {
  Matrix3<double> f[kStressBlock];
  Quaternion<double> q[kStressBlock];
  for (int k = 0; k < count; ++k) f[k] = to_plain(g[k]);
  nearest_rotations_cold(f, q, count);
  for (int k = 0; k < count; ++k) body(k, to_eigen(q[k]).toRotationMatrix());
}

}  // namespace

void CorotatedLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  for_rotations(g, count, [&](int k, const Eigen::Matrix3d& r) {
    // Ψ' = 2 (G - R) + ρ (R : (G - R)) R, of the difference, which keeps its digits near rest
    const Eigen::Matrix3d strain = g[k] - r;
    p[k] = 2.0 * strain + (ratio * r.cwiseProduct(strain).sum()) * r;
  });
}

void CorotatedLaw::energies(const Eigen::Matrix3d* g, int count, double* energy) const {
  for_rotations(g, count, [&](int k, const Eigen::Matrix3d& r) {
    const Eigen::Matrix3d strain = g[k] - r;
    const double trace = r.cwiseProduct(strain).sum();
    energy[k] = strain.squaredNorm() + 0.5 * ratio * trace * trace;
  });
}

Matrix9d CorotatedLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  // Ψ' = 2 (G - P) with P = U diag(p) Vᵀ, all p = 1 - ρ/2 (Σσ - 3)
  const PrincipalStretches stretches = principal_stretches(g);
  const double p = 1.0 - 0.5 * ratio * (stretches.sigma.sum() - 3.0);
  StretchSlope slope{Eigen::Matrix3d::Constant(-0.5 * ratio), Eigen::Vector3d::Zero(), {}};
  slope.twist = twist_slopes(stretches.sigma, Eigen::Vector3d::Constant(p));
  return 2.0 * distance_tangent(stretches, slope, definiteness);
}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, double stiffness, int first_particle)
    : TetrahedronSet(rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness),
                     first_particle) {}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, const LameParameters& lame,
                               int first_particle)
    : SimplexSet("tetrahedron",
                 make_tetrahedra("tetrahedron", rest,
                                 Eigen::VectorXd::Constant(rest.tetrahedra.cols(), lame.mu),
                                 first_particle),
                 {lame.lambda / lame.mu}) {
  if (!(std::isfinite(lame.lambda) && lame.lambda >= 0.0)) {
    throw InputError(fmt::format(
        "tetrahedron: the Lamé parameter λ is {} Pa, but must be finite and >= 0", lame.lambda));
  }
}

TetrahedronSet::TetrahedronSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
                               int first_particle)
    : SimplexSet("tetrahedron", make_tetrahedra("tetrahedron", rest, stiffness, first_particle),
                 {}) {}

void TetrahedronSet::add_damping(double time,
                                 std::vector<std::unique_ptr<ElementSet>>& sets) const {
  GradientStencils stencils;
  for (const Simplex<3>& s : simplices().elements) {
    std::vector<Eigen::Vector3d> shapes;
    for (int a = 0; a < 4; ++a) shapes.emplace_back(s.shape.col(a));
    stencils.add(s.weight, {s.vertices.begin(), s.vertices.end()}, shapes);
  }
  // Weights are volumes times μ.
  const auto all = std::make_shared<const GradientStencils>(std::move(stencils));
  sets.push_back(std::make_unique<ViscousStencilSet<ShearLaw>>(StencilPlaces{all, all}, 1.0, time));
  if (law().ratio == 0.0) return;
  sets.push_back(
      std::make_unique<ViscousStencilSet<PressureLaw>>(StencilPlaces{all, all}, law().ratio, time));
}

}  // namespace pliant
