#pragma once

#include <vector>

#include "pliant/geometry/patch/patch_fit.h"

namespace pliant {

/// Free-form patches as the paper writes them (PatchSurface names it), to be compared with those
/// that PatchBody has: each base triangle has perturbation quadrics of its own, which are summed,
///   F'(p) = F(p) + sum_i R(Q_i(p)),  R(Q) = Q³ where Q >= 0, else 0,
/// and clipping planes perpendicular to it. A perturbation only adds, so that the base lies within
/// the solid. Neighbours have nothing in common but the base's edge: between them the surface may
/// have gaps.
struct SummedPatches {
  TriangleMesh base;
  std::vector<std::vector<Quadric>> quadrics;  ///< of each triangle; Q³ is a height [m]
};

/// F'(p) [m] of one patch, also outside its half-spaces.
double value(const SummedPatches& body, int patch, const Eigen::Vector3d& p);

/// The surface's point [m] over the base point with these barycentric coordinates (each in [0, 1],
/// sum 1), along the triangle's normal: the lowest at which F' turns negative.
Eigen::Vector3d point(const SummedPatches& body, int patch, const Eigen::Vector3d& barycentric);

/// The most perturbations a triangle may have.
constexpr int kMostPerturbations = 8;

/// Patches with up to `each` quadrics a triangle, in [1, kMostPerturbations]: its samples, and
/// those of its neighbours, fall into so many groups by place and normal (Lloyd's iterations), and
/// each quadric is the least squares of value and gradient at those of a group; fewer where fewer
/// are nearer to the samples. The vertices of `base` are moved inwards where the samples lie below
/// it. Throws InputError for `each` out of its range.
SummedPatches fit_summed_patches(const TriangleMesh& base, const std::vector<FitSample>& samples,
                                 int each);

struct SummedReport {
  double max_distance = 0.0;  ///< [m] of the patches from the mesh, or of the mesh from them
  double rms_distance = 0.0;  ///< [m] of the patches from the mesh
  double widest_gap = 0.0;    ///< [m] between the patches at an edge of the base
  double rms_gap = 0.0;       ///< [m]
  int quadrics = 0;           ///< of all triangles
};

/// As compare() does it for a PatchBody, and what stands open between neighbours.
SummedReport compare(const SummedPatches& body, const TriangleMesh& mesh);

}  // namespace pliant
