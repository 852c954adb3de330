#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/search/box_hierarchy.h"

namespace pliant {

/// How often a surface winds around points, also one with holes, cracks and parts that pass through
/// each other: the sum of its triangles' solid angles over 4π (Jacobson et al. 2013, "Robust
/// inside-outside segmentation using generalized winding numbers"). Far triangles count together as
/// a dipole (Barill et al. 2018, "Fast winding numbers for soups and clouds"), which is off by a
/// few hundredths.
class GeneralizedWinding {
 public:
  /// Of finite vertices; it is copied.
  explicit GeneralizedWinding(TriangleMesh mesh);

  /// About 1 within a closed surface whose triangles turn outward, about 0 outside, one half in
  /// the middle of a hole. Safe to call from many threads.
  double operator()(const Eigen::Vector3d& p) const;

 private:
  struct Dipole {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // [m]
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // areas times normals [m²]
    double area = 0.0;                                 // [m²]
    double radius = 0.0;                               // around center, of all triangles [m]
  };
  void add_triangles(const BoxHierarchy::Node& node, Dipole& dipole) const;

  TriangleMesh mesh_;
  BoxHierarchy tree_;
  std::vector<Dipole> dipoles_;  // of the tree's nodes
};

}  // namespace pliant
