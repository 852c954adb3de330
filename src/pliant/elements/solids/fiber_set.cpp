#include "pliant/elements/solids/fiber_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/laws/fiber.h"
#include "pliant/math/error.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {

template class SimplexSet<FiberLaw>;

namespace {

// Stretch below which a fibre's resistance to turning, 1 - 1/|g₀|, is cut.
constexpr double kLeastStretch = 1e-12;

/// Where the fibre points.
Eigen::Vector3d along(const Eigen::Matrix3d& g) {
  return fiber_direction<Eigen::Vector3d>(g.col(0), g.col(1), g.col(2));
}

/// The tetrahedra in a rest frame whose x axis is `direction`.
Simplices<3> make_fibers(const TetrahedralMesh& rest, double stiffness,
                         const Eigen::Vector3d& direction, int first_particle) {
  if (!direction.allFinite() || direction.isZero(0.0)) {
    throw InputError(fmt::format("fiber: direction is ({}, {}, {}), but must be finite and not 0",
                                 direction[0], direction[1], direction[2]));
  }
  Simplices<3> fibers = make_tetrahedra(
      "fiber", rest, Eigen::VectorXd::Constant(rest.tetrahedra.cols(), stiffness), first_particle);
  Eigen::Matrix3d axes;
  axes.col(0) = direction.stableNormalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  for (Simplex<3>& fiber : fibers.elements) fiber.shape = axes.transpose() * fiber.shape;
  return fibers;
}

}  // namespace

void FiberLaw::stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const {
  for (int k = 0; k < count; ++k) {
    p[k].setZero();
    p[k].col(0) = fiber_stress<Eigen::Vector3d>(g[k].col(0), g[k].col(1), g[k].col(2));
  }
}

Matrix9d FiberLaw::tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const {
  // d²Ψ/dg₀² = u uᵀ + (1 - 1/|g₀|) (I - u uᵀ)
  const Eigen::Vector3d u = along(g);
  // Not stableNorm(), which sums in another order where G is at an odd address.
  const double stretch = std::max(g.col(0).norm(), kLeastStretch);
  double turning = 1.0 - 1.0 / stretch;
  if (definiteness == Definiteness::kProjected) turning = std::max(turning, 0.0);
  Matrix9d tangent = Matrix9d::Zero();
  tangent.topLeftCorner<3, 3>() =
      turning * Eigen::Matrix3d::Identity() + (1.0 - turning) * (u * u.transpose());
  return tangent;
}

FiberSet::FiberSet(const TetrahedralMesh& rest, double stiffness, const Eigen::Vector3d& direction,
                   int first_particle)
    : SimplexSet("fiber", make_fibers(rest, stiffness, direction, first_particle), {}) {}

void FiberSet::add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const {
  std::vector<StrainMeasure> strains;
  for (const Simplex<3>& s : simplices().elements) {
    StrainMeasure strain;
    strain.particles.assign(s.vertices.begin(), s.vertices.end());
    for (int k = 0; k < 4; ++k) strain.first.push_back(s.shape(0, k));
    strain.stiffness = s.weight;
    strains.push_back(strain);
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

}  // namespace pliant
