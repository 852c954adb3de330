#include "pliant/geometry/patch/patch_fit.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "pliant/geometry/meshing/simplify.h"
#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/geometry/patch/patch_refinement.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kSamplesPerEdge =
    12;  // of the mesh's vertices; with fewer, its triangles are sampled

TriangleMesh checked_solid(const TriangleMesh& mesh, const std::string& where) {
  validate(mesh, where);
  const Edges all = edges(mesh);
  const auto open = std::count_if(all.opposite.begin(), all.opposite.end(),
                                  [](const std::array<int, 2>& o) { return o[1] < 0; });
  if (open > 0) {
    throw InputError(fmt::format(
        "{}: the surface is open, it has {} boundary edges: close it first", where, open));
  }
  const double volume = signed_volume(mesh);
  if (volume > 0.0) return mesh;
  throw InputError(
      fmt::format("{}: the surface is inside out, it encloses {:.3g} m^3: reverse its triangles",
                  where, volume));
}

// Of the mesh's size, by which rounded numbers may move the surface: a hundredth of a good fit.
constexpr double kRounding = 1e-6;

template <class Values>
void round_to(int digits, Values& values) {
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    values.data()[k] =
        std::strtod(fmt::format("{:.{}g}", values.data()[k], digits).c_str(), nullptr);
  }
}

/// Three points of each patch, one after the other [m].
Eigen::Matrix3Xd points_of(const PatchSurface& surface) {
  Eigen::Matrix3Xd points(3, 3 * surface.patches());
  for (int t = 0; t < surface.patches(); ++t) {
    points.col(3 * t) = surface.point(t, {0.4, 0.3, 0.3});
    points.col(3 * t + 1) = surface.point(t, {0.1, 0.8, 0.1});
    points.col(3 * t + 2) = surface.point(t, {0.5, 0.0, 0.5});
  }
  return points;
}

/// The same body with no more digits than its surface needs, so that its file is short.
PatchBody shortened(const PatchBody& body) {
  constexpr int kFewest = 7, kAll = 17;
  const auto size =
      (body.base.vertices.rowwise().maxCoeff() - body.base.vertices.rowwise().minCoeff())
          .maxCoeff();
  const Eigen::Matrix3Xd points = points_of(PatchSurface(body));
  for (int digits = kFewest; digits < kAll; ++digits) {
    PatchBody rounded = body;
    round_to(digits, rounded.base.vertices);
    for (Quadric& quadric : rounded.quadrics) round_to(digits, quadric);
    try {
      const Eigen::Matrix3Xd moved = points_of(PatchSurface(rounded)) - points;
      if (moved.colwise().norm().maxCoeff() <= kRounding * size) return rounded;
    } catch (const InputError&) {
      // Too few: the surface would leave its vertices.
    }
  }
  return body;
}

/// The one of two bodies that is less far from the mesh at most: between the points that a
/// refinement looked at, its surface may stand out.
PatchBody nearer(const PatchBody& refined, const PatchBody& first, const TriangleMesh& mesh) {
  try {
    const FitReport now = compare(refined, mesh), before = compare(first, mesh);
    return now.max_distance < before.max_distance ? refined : first;
  } catch (const InputError&) {
    return first;  // where the refined surface folds
  }
}

}  // namespace

std::vector<FitSample> samples_of(const TriangleMesh& mesh, const TriangleMesh& base) {
  const NearestTriangle nearest(base);
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  std::vector<FitSample> samples;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Vector3d p = mesh.vertices.col(v);
    samples.push_back({p, normals.col(v), nearest(p).triangle});
  }
  if (2 * mesh.vertices.cols() >= 3 * kSamplesPerEdge * base.triangles.cols()) return samples;
  constexpr int kGrid = 5;
  for (const auto t : mesh.triangles.colwise()) {
    for (int i = 0; i < kGrid; ++i) {
      for (int j = 0; i + j < kGrid; ++j) {
        const Vector3d at = Vector3d(i, j, kGrid - 1 - i - j).array() / kGrid + 1.0 / (3 * kGrid);
        Vector3d p = Vector3d::Zero(), normal = Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
          p += at[k] * mesh.vertices.col(t[k]);
          normal += at[k] * normals.col(t[k]);
        }
        samples.push_back({p, normal.normalized(), nearest(p).triangle});
      }
    }
  }
  return samples;
}

FitReport compare(const PatchBody& body, const TriangleMesh& mesh) {
  const PatchSurface surface(body);
  const int level = std::clamp(
      static_cast<int>(std::sqrt(100'000.0 / static_cast<double>(surface.patches()))), 2, 16);
  const PatchPolygons polygons = polygonise(surface, level);
  FitReport report;
  report.source_triangles = static_cast<int>(mesh.triangles.cols());
  report.triangles = surface.patches();
  const NearestTriangle to_mesh(mesh), to_patches(polygons.mesh);
  double squares = 0.0;
  for (const auto v : polygons.mesh.vertices.colwise()) {
    const double distance = to_mesh(v).distance;
    squares += distance * distance;
    report.max_distance = std::max(report.max_distance, distance);
  }
  report.rms_distance = std::sqrt(squares / static_cast<double>(polygons.mesh.vertices.cols()));
  for (const auto v : mesh.vertices.colwise()) {
    report.max_distance = std::max(report.max_distance, to_patches(v).distance);
  }
  return report;
}

PatchFit fit_patches(const TriangleMesh& mesh, const FitOptions& options,
                     const std::string& where) {
  if (options.triangles < 4 || options.triangles > kMaxTriangles) {
    throw InputError(fmt::format("{}: triangles is {}: allowed is [4, {}]", where,
                                 options.triangles, kMaxTriangles));
  }
  const TriangleMesh solid = checked_solid(mesh, where);
  const TriangleMesh base = simplify(solid, options.triangles, where);
  PatchFit fit;
  try {
    const PatchBody first = fit_quadrics(base, samples_of(solid, base));
    fit.body = shortened(nearer(refine_quadrics(first, NearestTriangle(solid)), first, solid));
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("{}: a base of {} triangles is too coarse for this mesh ({}): choose more",
                    where, base.triangles.cols(), error.what()));
  }
  fit.report = compare(fit.body, solid);
  return fit;
}

}  // namespace pliant
