#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

/// A point of the surface to fit, over one of the base's triangles.
struct FitSample {
  Eigen::Vector3d point;   ///< [m]
  Eigen::Vector3d normal;  ///< outward unit
  int triangle;            ///< of the base
};

/// Quadrics for the edges of a base whose vertices lie on the surface: each the least squares of
/// value and gradient at the samples over the two triangles beside its edge (and, where these are
/// few, those beside them), zero at the edge's vertices. Where a patch would leave its surroundings
/// or fold, its quadrics are drawn towards planes; where triangles fit better flat, an edge between
/// two of them has none. Equal samples give the same bits.
PatchBody fit_quadrics(const TriangleMesh& base, const std::vector<FitSample>& samples);

/// Of a mesh, over a base whose vertices are some of the mesh's: the mesh's vertices, and where
/// these are few also points of its triangles.
std::vector<FitSample> samples_of(const TriangleMesh& mesh, const TriangleMesh& base);

struct FitOptions {
  int triangles = 320;  ///< of the base; at least 4
};

struct FitReport {
  double max_distance = 0.0;  ///< [m] between the two surfaces, either way
  double rms_distance = 0.0;  ///< [m] of the fitted surface from the mesh
  int source_triangles = 0;
  int triangles = 0;
};

struct PatchFit {
  PatchBody body;
  FitReport report;
};

/// Patches for a closed triangle mesh: simplify() gives the base, whose vertices are the mesh's,
/// fit_quadrics() and refine_quadrics() the rest, with no more digits than move the surface by a
/// millionth of the mesh's size. Distances are those of a fine polygonisation's vertices to the
/// mesh and of the mesh's vertices to it. Throws InputError, its message beginning with `where`,
/// when validate() refuses the mesh, it is open or inside out, an option is outside its range, or
/// the base is so coarse that it folds onto itself.
PatchFit fit_patches(const TriangleMesh& mesh, const FitOptions& options,
                     const std::string& where = "mesh");

/// The distances between a body and a closed mesh, as fit_patches() reports them.
FitReport compare(const PatchBody& body, const TriangleMesh& mesh);

}  // namespace pliant
