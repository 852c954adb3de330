#include "pliant/geometry/patch/patch_shapes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pliant/geometry/mesh/vertex_welder.h"
#include "pliant/geometry/patch/patch_fit.h"
#include "pliant/math/error.h"
#include "pliant/math/pi.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kSampleGrid = 8;

void check_length(const char* name, double length) {
  if (length > 0.0 && std::isfinite(length)) return;
  throw InputError(fmt::format("{} is {} m: allowed is any length > 0", name, length));
}

void check_count(const char* name, int count, int least, int most) {
  if (count >= least && count <= most) return;
  throw InputError(fmt::format("{} is {}: allowed is [{}, {}]", name, count, least, most));
}

/// Before any is made: fitting takes 2.5 kB a patch and more.
void check_patches(double count, const std::string& fields) {
  if (count <= kMaxShapePatches) return;
  throw InputError(fmt::format("{} make {:.0f} patches: at most {} are allowed", fields, count,
                               kMaxShapePatches));
}

/// Fits quadrics to the points at `radius` from core(p), where core gives the point of a skeleton
/// (a point, circle, segment or box) that is nearest to p.
template <typename Core>
PatchBody fit_offset(const TriangleMesh& base, double radius, const Core& core) {
  std::vector<FitSample> samples;
  for (int t = 0; t < base.triangles.cols(); ++t) {
    for (int i = 0; i <= kSampleGrid; ++i) {
      for (int j = 0; i + j <= kSampleGrid; ++j) {
        const Vector3d at = Vector3d(i, j, kSampleGrid - i - j) / kSampleGrid;
        Vector3d p = Vector3d::Zero();
        for (int k = 0; k < 3; ++k) p += at[k] * base.vertices.col(base.triangles(k, t));
        const Vector3d inner = core(p);
        const Vector3d normal = (p - inner).normalized();
        samples.push_back({inner + radius * normal, normal, t});
      }
    }
  }
  return fit_quadrics(base, samples);
}

TriangleMesh as_mesh(const std::vector<std::array<Vector3d, 3>>& triangles) {
  VertexWelder welder;
  TriangleMesh mesh;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) =
          welder.add(triangles[t][k]);
    }
  }
  mesh.vertices = welder.vertices();
  return mesh;
}

TriangleMesh icosahedron() {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh;
  mesh.vertices.resize(3, 12);
  mesh.triangles.resize(3, 20);
  // Corners of three golden rectangles, and the faces about them.
  int v = 0, t = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double s : {-1.0, 1.0}) {
      for (const double r : {-g, g}) {
        mesh.vertices.col(v).setZero();
        mesh.vertices(axis, v) = s;
        mesh.vertices((axis + 1) % 3, v++) = r;
      }
    }
  }
  for (int a = 0; a < 12; ++a) {
    for (int b = a + 1; b < 12; ++b) {
      for (int c = b + 1; c < 12; ++c) {
        const Vector3d x = mesh.vertices.col(a), y = mesh.vertices.col(b), z = mesh.vertices.col(c);
        const double longest = std::max({(x - y).norm(), (y - z).norm(), (z - x).norm()});
        if (longest > 2.1) continue;  // edges are 2 long
        const bool outward = x.cross(y).dot(z) > 0.0;
        mesh.triangles.col(t++) << a, (outward ? b : c), (outward ? c : b);
      }
    }
  }
  mesh.vertices.colwise().normalize();
  return mesh;
}

/// Each triangle cut into four, the new vertices on the unit sphere.
TriangleMesh refined_on_sphere(const TriangleMesh& mesh) {
  std::vector<std::array<Vector3d, 3>> triangles;
  for (const auto t : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]);
    const Vector3d c = mesh.vertices.col(t[2]);
    const Vector3d ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return as_mesh(triangles);
}

using Quads = std::vector<std::array<Vector3d, 4>>;

/// Quadrilaterals, counter-clockwise from outside, cut along their shorter diagonals.
TriangleMesh cut_quads(const Quads& quads) {
  std::vector<std::array<Vector3d, 3>> triangles;
  for (const auto& [a, b, c, d] : quads) {
    const bool along_ac = (a - c).norm() <= (b - d).norm();
    const std::array<std::array<Vector3d, 3>, 2> halves =
        along_ac ? std::array<std::array<Vector3d, 3>, 2>{{{a, b, c}, {a, c, d}}}
                 : std::array<std::array<Vector3d, 3>, 2>{{{a, b, d}, {b, c, d}}};
    for (const auto& half : halves) {
      if (half[0] != half[1] && half[1] != half[2] && half[2] != half[0]) triangles.push_back(half);
    }
  }
  return as_mesh(triangles);
}

/// Exactly 0 and exactly the same at both ends of the turn, so that vertices weld.
Vector3d on_circle(int step, int steps, double radius) {
  const double angle = 2.0 * kPi * (step % steps) / steps;
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

}  // namespace

PatchBody make_sphere_patches(double radius, int level) {
  check_length("radius", radius);
  check_count("level", level, 0, 4);
  TriangleMesh base = icosahedron();
  for (int k = 0; k < level; ++k) base = refined_on_sphere(base);
  base.vertices *= radius;
  return fit_offset(base, radius, [](const Vector3d&) { return Vector3d(Vector3d::Zero()); });
}

PatchBody make_torus_patches(double ring, double tube, int around, int across) {
  check_length("ring", ring);
  check_length("tube", tube);
  check_count("around", around, 3, 1000);
  check_count("across", across, 3, 1000);
  check_patches(2.0 * around * across, fmt::format("around {} and across {}", around, across));
  if (tube >= ring) {
    throw InputError(fmt::format("tube is {} m: allowed is less than ring, {} m", tube, ring));
  }
  const auto at = [&](int u, int w) {
    const Vector3d profile = on_circle(w, across, tube);
    return Vector3d(on_circle(u, around, ring + profile[0]) + Vector3d(0.0, 0.0, profile[1]));
  };
  Quads quads;
  for (int u = 0; u < around; ++u) {
    for (int w = 0; w < across; ++w) {
      quads.push_back({at(u, w), at(u + 1, w), at(u + 1, w + 1), at(u, w + 1)});
    }
  }
  return fit_offset(cut_quads(quads), tube, [&](const Vector3d& p) {
    return Vector3d(Vector3d(p[0], p[1], 0.0).normalized() * ring);
  });
}

PatchBody make_capsule_patches(double radius, double length, int around, int rings) {
  check_length("radius", radius);
  check_length("length", length);
  check_count("around", around, 3, 1000);
  check_count("rings", rings, 1, 1000);
  check_patches(4.0 * around * rings, fmt::format("around {} and rings {}", around, rings));
  // Latitudes from the lower pole to the upper one; the equator twice, at both ends of the
  // cylinder.
  const auto at = [&](int u, int ring) {
    const bool upper = ring > rings;
    const int step = upper ? ring - rings - 1 : ring - rings;  // from the equator
    const double latitude = 0.5 * kPi * step / rings;
    const double z = (upper ? 0.5 : -0.5) * length + radius * std::sin(latitude);
    const bool is_pole = std::abs(step) == rings;
    return Vector3d(on_circle(u, around, is_pole ? 0.0 : radius * std::cos(latitude)) +
                    Vector3d(0.0, 0.0, z));
  };
  Quads quads;
  for (int ring = 0; ring < 2 * rings + 1; ++ring) {
    for (int u = 0; u < around; ++u) {
      quads.push_back({at(u, ring), at(u + 1, ring), at(u + 1, ring + 1), at(u, ring + 1)});
    }
  }
  return fit_offset(cut_quads(quads), radius, [&](const Vector3d& p) {
    return Vector3d(0.0, 0.0, std::clamp(p[2], -0.5 * length, 0.5 * length));
  });
}

PatchBody make_rounded_box_patches(const Eigen::Vector3d& size, double radius, int segments) {
  for (const double length : size) check_length("size", length);
  check_length("radius", radius);
  check_count("segments", segments, 1, 100);
  const double side = 2.0 * segments + 1.0;
  check_patches(12.0 * side * side, fmt::format("segments {}", segments));
  const double most = 0.5 * size.minCoeff() * (1.0 - 1e-3);
  if (radius > most) {
    throw InputError(fmt::format("radius is {} m: allowed is (0, {}]", radius, most));
  }
  const Vector3d core = 0.5 * size.array() - radius;
  const int n = segments;
  // Nodes 0..n of an axis belong to the low corner, n+1..2n+1 to the high one.
  const auto at = [&](const std::array<int, 3>& node) {
    Vector3d inner, direction;
    for (int k = 0; k < 3; ++k) {
      const int i = node[static_cast<std::size_t>(k)];
      inner[k] = i <= n ? -core[k] : core[k];
      // Even angles on the faces' middle lines.
      direction[k] = std::tan(0.25 * kPi * (i <= n ? i - n : i - n - 1) / n);
    }
    return Vector3d(inner + radius * direction.normalized());
  };
  Quads quads;
  for (int axis = 0; axis < 3; ++axis) {
    const auto u = static_cast<std::size_t>((axis + 1) % 3);
    const auto v = static_cast<std::size_t>((axis + 2) % 3);
    for (const bool high : {false, true}) {
      for (int i = 0; i <= 2 * n; ++i) {
        for (int j = 0; j <= 2 * n; ++j) {
          const auto node = [&](int di, int dj) {
            std::array<int, 3> result{};
            result[static_cast<std::size_t>(axis)] = high ? 2 * n + 1 : 0;
            result[u] = i + di;
            result[v] = j + dj;
            return at(result);
          };
          const Vector3d a = node(0, 0), b = node(1, 0), c = node(1, 1), d = node(0, 1);
          quads.push_back(high ? std::array<Vector3d, 4>{a, b, c, d}
                               : std::array<Vector3d, 4>{a, d, c, b});
        }
      }
    }
  }
  return fit_offset(cut_quads(quads), radius,
                    [&](const Vector3d& p) { return Vector3d(p.cwiseMax(-core).cwiseMin(core)); });
}

}  // namespace pliant
