#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/meshing/quadric.h"

namespace pliant {

/// A surface of free-form patches as it stands in a file: base triangles, and on each of their
/// edges one perturbation quadric that the triangles on both sides share.
struct PatchBody {
  TriangleMesh base;
  std::vector<std::array<int, 2>> edges;  ///< as edges(base) orders them
  std::vector<Quadric> quadrics;          ///< one an edge; Q³ is a height [m]
  bool dents = true;                      ///< whether Q < 0 perturbs inward
};

/// Throws InputError, its message beginning with `where`, when validate() refuses the base mesh,
/// quadrics are not one an edge or not finite, the surface would leave the vertices at an edge's
/// ends (by more than 1e-6 of its length), or neighbours fold back on each other (their normals are
/// more than 170 degrees apart).
void validate(const PatchBody& body, const std::string& where);

/// As validate(), and refuses a body without inside: an open base, with the number of its boundary
/// edges, and one that is inside out.
void validate_solid(const PatchBody& body, const std::string& where);

/// The implicit functions of a body's free-form patches ("Method for modeling the deformation of
/// elastic functionally defined objects", figure 1 and the formulas below it).
///
/// A patch is its base triangle as the intersection of five half-spaces, three clipping planes
/// through the edges and two base planes that face opposite ways, composed with perturbations:
///   F'(p) = F(p) + R(Q(p)),  R(Q) = Q³ where Q >= 0, else 0,
/// inside where F' >= 0. F = -n . (p - v1) [m] is the outward base plane's. The cube joins the
/// bulge to the triangle with two continuous derivatives. A body with dents subtracts R(-Q) too.
///
/// Where the paper's clipping planes, perpendicular to each triangle, would leave a wedge-shaped
/// gap at a convex edge, both neighbours take the plane that bisects them; on a flat edge and on
/// one with a single triangle it is the paper's plane. On the bisecting plane both have the same F
/// and, by
///   Q(p) = sum_e w_e(p) Q_e(p),  w_e = (s_f s_g)² / (sum of all three such products),
/// with s_e(p) the distance to the clipping plane of edge e, 1 at the opposite vertex, the same Q
/// with the same gradient: the surface has no cracks, by construction, and where the perturbation
/// is steep, no visible edges. In a vertex, Q is 0: the surface passes through the base's vertices.
class PatchSurface {
 public:
  /// Throws InputError as validate() does.
  explicit PatchSurface(PatchBody body, const std::string& where = "patches");

  const PatchBody& body() const { return body_; }
  int patches() const { return static_cast<int>(cells_.size()); }

  /// F'(p) [m] of one patch, also outside its half-spaces.
  double value(int patch, const Eigen::Vector3d& p) const;
  /// Its gradient, 3.
  Eigen::Vector3d gradient(int patch, const Eigen::Vector3d& p) const;
  /// The outward unit normal of its level sets at p.
  Eigen::Vector3d normal(int patch, const Eigen::Vector3d& p) const;

  /// Whether p lies within the three clipping planes and between the two base planes, the outer one
  /// perturbed.
  bool contains(int patch, const Eigen::Vector3d& p) const;
  /// Whether p lies within the body, whose base must be closed.
  bool inside(const Eigen::Vector3d& p) const;

  /// The surface's point [m] over the base point with these barycentric coordinates (each in
  /// [0, 1], sum 1): on the ray from there along the mean of the bisecting planes' directions.
  /// The same, to round-off, from both sides of an edge.
  Eigen::Vector3d point(int patch, const Eigen::Vector3d& barycentric) const;

  /// How that point moves where quadrics change: along its ray, to first order by
  ///   point' = point + direction Σ_e rates_e dQ_e(point),
  /// the sum over the patch's edges, e opposite corner e.
  struct PointMotion {
    Eigen::Vector3d point;        ///< [m]
    Eigen::Vector3d direction;    ///< of about length 1
    std::array<double, 3> rates;  ///< [m]
  };
  PointMotion motion(int patch, const Eigen::Vector3d& barycentric) const;

 private:
  struct Cell {
    std::array<Eigen::Vector3d, 3> corners;
    Eigen::Vector3d normal;                   ///< of the base triangle, outward unit
    std::array<Eigen::Vector3d, 3> slope;     ///< gradients of s_e, e opposite corner e
    std::array<double, 3> offset;             ///< s_e = slope_e . p + offset_e
    std::array<Eigen::Vector3d, 3> bisector;  ///< unit, in the clipping plane, across the edge
    std::array<Quadric, 3> quadric;
    double size;        ///< longest edge [m]
    double slab = 0.0;  ///< half distance between the base planes [m]
  };
  struct Ray {
    Eigen::Vector3d from, direction;
  };
  struct Blend {
    double value;              ///< Q
    Eigen::Vector3d gradient;  ///< of Q
  };

  void build_cells();
  static Ray ray(const Cell& cell, const Eigen::Vector3d& barycentric);
  static std::array<double, 3> distances(const Cell& cell, const Eigen::Vector3d& p);
  Blend blend(const Cell& cell, const Eigen::Vector3d& p) const;
  double height(const Cell& cell, const Eigen::Vector3d& from,
                const Eigen::Vector3d& direction) const;
  double winding_number(const Eigen::Vector3d& p) const;

  PatchBody body_;
  std::vector<Cell> cells_;
};

}  // namespace pliant
