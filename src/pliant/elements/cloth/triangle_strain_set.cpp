#include "pliant/elements/cloth/triangle_strain_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/math/error.h"

namespace pliant {

template class SimplexSet<MembraneLaw>;

namespace {

// The warp vector's least share within its triangle's plane.
constexpr double kLeastShare = 1e-6;

/// Unit vectors along warp, weft and the normal.
Eigen::Matrix3d frame(const TriangleMesh& rest, const Eigen::Vector3d& warp, int triangle) {
  const Eigen::Vector3i v = rest.triangles.col(triangle);
  const Eigen::Vector3d a = rest.vertices.col(v[1]) - rest.vertices.col(v[0]);
  const Eigen::Vector3d b = rest.vertices.col(v[2]) - rest.vertices.col(v[0]);
  Eigen::Matrix3d axes;
  axes.col(2) = a.stableNormalized().cross(b.stableNormalized()).normalized();
  const Eigen::Vector3d direction = warp.stableNormalized();
  const Eigen::Vector3d within = direction - axes.col(2) * axes.col(2).dot(direction);
  if (!(within.norm() >= kLeastShare)) {
    throw InputError(fmt::format(
        "triangle_strain: the warp vector ({}, {}, {}) of triangle {} has no part in its plane",
        warp[0], warp[1], warp[2], triangle));
  }
  axes.col(0) = within.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Simplices<2> make_triangles(const TriangleMesh& rest, const Eigen::Matrix3Xd& warp) {
  validate(rest, "triangle_strain");
  if (warp.cols() != rest.triangles.cols()) {
    throw InputError(fmt::format("triangle_strain: {} warp vectors for {} triangles; give one each",
                                 warp.cols(), rest.triangles.cols()));
  }
  std::vector<Simplex<2>> elements(static_cast<std::size_t>(warp.cols()));
  for (int t = 0; t < warp.cols(); ++t) {
    Simplex<2>& element = elements[static_cast<std::size_t>(t)];
    const Eigen::Vector3i v = rest.triangles.col(t);
    element.vertices = {v[0], v[1], v[2]};
    const Eigen::Matrix3d axes = frame(rest, warp.col(t), t);
    Eigen::Matrix2d sides;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d side = rest.vertices.col(v[k + 1]) - rest.vertices.col(v[0]);
      sides.col(k) = axes.leftCols<2>().transpose() * side;
    }
    element.shape = shape_gradients<2>(sides);
    element.weight = 0.5 * std::abs(sides(0, 0) * sides(1, 1) - sides(0, 1) * sides(1, 0));
  }
  return color_simplices<2>(elements, static_cast<int>(rest.vertices.cols()));
}

}  // namespace

TriangleStrainSet::TriangleStrainSet(const TriangleMesh& rest, const Eigen::Matrix3Xd& warp,
                                     const MembraneMaterial& material)
    : SimplexSet("triangle_strain", make_triangles(rest, warp), {material}) {
  check("triangle_strain", material);
}

void TriangleStrainSet::add_damping(double time,
                                    std::vector<std::unique_ptr<ElementSet>>& sets) const {
  const MembraneMaterial& material = law().material;
  std::vector<StrainMeasure> strains;
  for (const Simplex<2>& s : simplices().elements) {
    StrainMeasure strain;
    strain.particles = {s.vertices[0], s.vertices[1], s.vertices[2]};
    const auto add = [&](double stiffness, const Eigen::Vector3d& first,
                         const Eigen::Vector3d& second) {
      if (stiffness == 0.0) return;
      strain.stiffness = s.weight * stiffness;
      strain.first.assign(first.data(), first.data() + 3);
      strain.second.assign(second.data(), second.data() + 3);
      if (second.isZero(0.0)) strain.second.clear();
      strains.push_back(strain);
    };
    const Eigen::Vector3d a = s.shape.row(0), b = s.shape.row(1);
    add(material.warp, a, Eigen::Vector3d::Zero());
    add(material.weft, b, Eigen::Vector3d::Zero());
    // (|a + b| − |a − b|)/√2, the shear angle of small strains.
    add(material.shear, std::sqrt(0.5) * (a + b), std::sqrt(0.5) * (a - b));
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

Eigen::Matrix2Xd TriangleStrainSet::stretches(const Positions& x) const {
  Eigen::Matrix2Xd result(2, size());
  for (std::size_t e = 0; e < simplices().elements.size(); ++e) {
    const Gradient<2> g = simplices().elements[e].gradient(x);
    result.col(simplices().order[e]) << g.col(0).norm(), g.col(1).norm();
  }
  return result;
}

void TriangleStrainSet::add_yarns(std::vector<Yarn>& yarns) const {
  for (const Simplex<2>& t : simplices().elements) {
    for (int k = 0; k < 2; ++k) {
      // Weights of at most 1 make it a length.
      const double length = 1.0 / t.shape.row(k).cwiseAbs().maxCoeff();
      const Eigen::RowVector3d w = length * t.shape.row(k);
      yarns.push_back({t.vertices, {w[0], w[1], w[2]}, length});
    }
  }
}

void TriangleStrainSet::add_edges(std::vector<ClothEdge>& edges) const {
  for (const Simplex<2>& t : simplices().elements) {
    Eigen::Matrix<double, 2, 3> corners;  // along warp and weft [m]
    corners << Eigen::Vector2d::Zero(), t.shape.rightCols<2>().transpose().inverse();
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      edges.push_back({t.vertices[static_cast<std::size_t>(k)],
                       t.vertices[static_cast<std::size_t>(next)],
                       (corners.col(next) - corners.col(k)).lpNorm<1>()});
    }
  }
}

void TriangleStrainSet::add_strains(const Positions& x, Eigen::VectorXd& sum,
                                    Eigen::VectorXd& count) const {
  const Eigen::Matrix2Xd all = stretches(x);
  std::vector<const Simplex<2>*> in_order(simplices().elements.size());
  for (std::size_t e = 0; e < in_order.size(); ++e) {
    in_order[static_cast<std::size_t>(simplices().order[e])] = &simplices().elements[e];
  }
  for (std::size_t t = 0; t < in_order.size(); ++t) {
    for (const int i : in_order[t]->vertices) {
      sum[i] += all.col(static_cast<Eigen::Index>(t)).sum() - 2.0;
      count[i] += 2.0;
    }
  }
}

}  // namespace pliant
