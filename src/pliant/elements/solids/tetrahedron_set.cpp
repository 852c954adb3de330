#include "pliant/elements/solids/tetrahedron_set.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/stencil_set.h"
#include "pliant/laws/corotated.h"
#include "pliant/math/error.h"
#include "pliant/math/rotation_batch.h"
#include "pliant/math/rotation_eigen.h"
#include "pliant/math/symmetric_eigen3.h"

namespace pliant {

template class SimplexSet<CorotatedLaw>;

namespace {

/// Calls body(k, G, R) with the rotation R nearest to each G.
template <class Body>
void for_rotations(const Eigen::Matrix3d* g, int count, const Body& body) {
  Matrix3<double> f[kStressBlock];
  Quaternion<double> q[kStressBlock];
  for (int k = 0; k < count; ++k) f[k] = to_plain(g[k]);
  nearest_rotations_cold(f, q, count);
  for (int k = 0; k < count; ++k) {
    body(k, f[k], to_plain(to_eigen(q[k]).toRotationMatrix()));
  }
}

}  // namespace

void CorotatedLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  for_rotations(g, count, [&](int k, const Matrix3<double>& plain, const Matrix3<double>& r) {
    p[k] = to_eigen(corotated_stress(plain, r, ratio));
  });
}

void CorotatedLaw::energies(const Eigen::Matrix3d* g, int count, double* energy) const {
  for_rotations(g, count, [&](int k, const Matrix3<double>& plain, const Matrix3<double>& r) {
    energy[k] = corotated_energy(plain, r, ratio);
  });
}

namespace {

// Rotations are ambiguous where tr(S) I − S is singular; this share of the trace above that is far
// enough for its inverse.
constexpr double kFirm = 1e-6;
// A twist whose stiffness is above its limit by no more than this share is at the limit.
constexpr double kSame = 1e-10;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

/// Whether all eigenvalues of the symmetric matrix `a` are above `least`.
bool is_above(const Eigen::Matrix3d& a, double least) {
  const double x = a(0, 0) - least, y = a(1, 1) - least, z = a(2, 2) - least;
  const double minor = x * y - a(0, 1) * a(0, 1);
  const double determinant =
      minor * z + 2.0 * a(0, 1) * a(1, 2) * a(0, 2) - x * a(1, 2) * a(1, 2) - y * a(0, 2) * a(0, 2);
  return x > 0.0 && minor > 0.0 && determinant > 0.0;
}

/// What twists take of the stiffness, T = Σ twistₖ vₖ vₖᵀ with twistₖ = 2 p/(σᵢ + σⱼ), where σₖ and
/// vₖ are eigenvalues and eigenvectors of the stretch S. That is 2 p (tr(S) I − S)⁻¹, which needs
/// no eigenvectors. With kProjected no twist is above 1: then the tangent is positive semidefinite.
Eigen::Matrix3d twist_of(const Eigen::Matrix3d& g, const Eigen::Matrix3d& s, double p,
                         Definiteness definiteness) {
  const double trace = s.trace();
  Eigen::Matrix3d sums = -s;
  sums.diagonal().array() += trace;
  if (is_above(sums, kFirm * trace)) {
    const bool is_projected = definiteness == Definiteness::kProjected;
    if (!is_projected || is_above(sums, 2.0 * p)) return 2.0 * p * sums.inverse();
    if (is_above(-sums, -2.0 * p - kSame)) return Eigen::Matrix3d::Identity();
    const SymmetricEigen3 eigen = symmetric_eigen3(sums);
    const Eigen::Vector3d twists = (2.0 * p * eigen.values.cwiseInverse()).cwiseMin(1.0);
    return eigen.vectors * twists.asDiagonal() * eigen.vectors.transpose();
  }
  const PrincipalStretches stretches = principal_stretches(g);
  Eigen::Vector3d twist = twist_slopes(stretches.sigma, Eigen::Vector3d::Constant(p));
  if (definiteness == Definiteness::kProjected) twist = twist.cwiseMin(1.0);
  return stretches.v * twist.asDiagonal() * stretches.v.transpose();
}

/// `rotation` is that nearest to G.
void find_blocks_at(const CorotatedLaw& law, const Simplex<3>& s, const Eigen::Matrix3d& g,
                    const Eigen::Matrix3d& rotation, Definiteness definiteness,
                    VertexBlocks<3>& blocks) {
  // Ψ' = 2 (G − P) with P = U diag(p) Vᵀ, all p = 1 − ρ/2 (Σσ − 3). Of the eigenmatrices of dP/dG
  // (principal_stretches.h) those of flips have the slope 0, and stretches slope along R alone:
  // d²Ψ/dG² = 2 (I + ρ/2 r rᵀ − 1/2 Σ twistₖ tₖ tₖᵀ) with r = R and tₖ = R [vₖ]×. Where G changes
  // by dx gᵀ, r sees R g of it and tₖ sees R (g × vₖ).
  const Eigen::Matrix3d stretch = rotation.transpose() * g;
  const double p = 1.0 - 0.5 * law.ratio * (stretch.trace() - 3.0);
  const Eigen::Matrix3d twist = twist_of(g, 0.5 * (stretch + stretch.transpose()), p, definiteness);
  std::array<Eigen::Matrix3d, 4> seen;
  for (int a = 0; a < 4; ++a) {
    seen[static_cast<std::size_t>(a)].noalias() = rotation * cross_matrix(s.shape.col(a));
  }
  const Eigen::Matrix<double, 3, 4> along = rotation * s.shape;
  auto block = blocks.begin();
  for (int r = 0; r < 4; ++r) {
    const Eigen::Matrix3d scaled = -seen[static_cast<std::size_t>(r)] * twist;
    const Eigen::Vector3d pushed = law.ratio * along.col(r);
    for (int c = r; c < 4; ++c, ++block) {
      block->noalias() = scaled * seen[static_cast<std::size_t>(c)].transpose();
      block->noalias() += pushed * along.col(c).transpose();
      block->diagonal().array() += 2.0 * s.shape.col(r).dot(s.shape.col(c));
    }
  }
}

}  // namespace

void find_vertex_blocks(const CorotatedLaw& law, const Simplex<3>& s, const Eigen::Matrix3d& g,
                        Definiteness definiteness, VertexBlocks<3>& blocks) {
  find_vertex_blocks(law, &s, &g, 1, definiteness, &blocks);
}

void find_vertex_blocks(const CorotatedLaw& law, const Simplex<3>* simplices,
                        const Eigen::Matrix3d* g, int count, Definiteness definiteness,
                        VertexBlocks<3>* blocks) {
  for_rotations(g, count, [&](int k, const Matrix3<double>&, const Matrix3<double>& r) {
    find_blocks_at(law, simplices[k], g[k], to_eigen(r), definiteness, blocks[k]);
  });
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
