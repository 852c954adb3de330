#include "pliant/geometry/mesh/display_surface.h"

#include <cmath>
#include <vector>

#include "pliant/geometry/mesh/grid.h"
#include "pliant/math/pi.h"

namespace pliant {
namespace {

constexpr int kSegments = 48;  // around the axis; a multiple of 4 meets the bounding box

struct ProfilePoint {
  double r;
  double z;
};

// Turns a profile around z. It runs upwards, from `bottom` to `top` on the axis, over the rings.
TriangleMesh revolve(double bottom, const std::vector<ProfilePoint>& rings, double top) {
  const int count = static_cast<int>(rings.size());
  const int pole = count * kSegments;
  TriangleMesh mesh;
  mesh.vertices.resize(3, pole + 2);
  mesh.triangles.resize(3, 2 * kSegments * count);
  int next = 0;
  for (int s = 0; s < kSegments; ++s) {
    const double angle = 2.0 * kPi * s / kSegments;
    const int after = (s + 1) % kSegments;
    for (int i = 0; i < count; ++i) {
      const int low = i * kSegments;
      mesh.vertices.col(low + s) << rings[i].r * std::cos(angle), rings[i].r * std::sin(angle),
          rings[i].z;
      if (i + 1 == count) continue;
      const int high = low + kSegments;
      mesh.triangles.col(next++) << low + s, low + after, high + after;
      mesh.triangles.col(next++) << low + s, high + after, high + s;
    }
    const int last = (count - 1) * kSegments;
    mesh.triangles.col(next++) << pole, after, s;
    mesh.triangles.col(next++) << pole + 1, last + s, last + after;
  }
  mesh.vertices.col(pole) << 0.0, 0.0, bottom;
  mesh.vertices.col(pole + 1) << 0.0, 0.0, top;
  return mesh;
}

}  // namespace

TriangleMesh square_surface(double side) {
  GridOptions options;
  options.width = side;
  options.height = side;
  return make_grid(options);
}

TriangleMesh box_surface(const Eigen::Vector3d& half_size) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    mesh.vertices.col(i) = half_size.cwiseProduct(corner);
  }
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      1, 3, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

TriangleMesh capsule_surface(double radius, double length) {
  const int bands = kSegments / 4;  // from a pole to the equator
  std::vector<ProfilePoint> rings;
  for (int half = -1; half <= 1; half += 2) {
    for (int i = 0; i < bands; ++i) {
      const int step = half < 0 ? i + 1 : i + bands;
      const double angle = kPi * step / (2 * bands);  // from the lower pole
      // The upper half of a sphere would repeat the equator.
      if (half > 0 && i == 0 && length == 0.0) continue;
      rings.push_back({radius * std::sin(angle), half * length / 2.0 - radius * std::cos(angle)});
    }
  }
  return revolve(-length / 2.0 - radius, rings, length / 2.0 + radius);
}

TriangleMesh cylinder_surface(double radius, double length) {
  const double half = length / 2.0;
  return revolve(-half, {{radius, -half}, {radius, half}}, half);
}

}  // namespace pliant
