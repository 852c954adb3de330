#include "pliant/geometry/distance/distance_grid.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "pliant/geometry/distance/closest_point.h"
#include "pliant/geometry/distance/voxel_band.h"

namespace pliant {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;

constexpr int kUnknown = -1;

// All lengths below are in spacings from the grid's origin.
struct Samples {
  Array3i count;
  std::vector<char> inside;
  std::vector<int> triangle;     // the nearest one known
  std::vector<double> distance;  // to it

  std::size_t index(const Array3i& at) const {
    return (static_cast<std::size_t>(at[2]) * count[1] + at[1]) * count[0] + at[0];
  }
};

Eigen::Matrix3Xd in_spacings(const TriangleMesh& mesh, const DistanceGrid& grid) {
  return (mesh.vertices.colwise() - grid.origin) / grid.spacing;
}

// Hands the nearest triangles on from sample to sample: 2 passes back and forth over all 26
// neighbours. OpenVDB's own distances are off by up to half a spacing outside its innermost band.
class Propagation {
 public:
  Propagation(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles, Samples& samples)
      : vertices_(vertices), triangles_(triangles), samples_(samples) {}

  void run() {
    samples_.distance.assign(samples_.triangle.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < samples_.triangle.size(); ++i) {
      const int known = std::exchange(samples_.triangle[i], kUnknown);
      if (known != kUnknown) offer(i, position(i), known);
    }
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < samples_.triangle.size(); ++i) ask_neighbours(i, -1);
      for (std::size_t i = samples_.triangle.size(); i-- > 0;) ask_neighbours(i, 1);
    }
  }

 private:
  Array3i coordinates(std::size_t i) const {
    const std::size_t row = i / samples_.count[0];
    return {static_cast<int>(i % samples_.count[0]), static_cast<int>(row % samples_.count[1]),
            static_cast<int>(row / samples_.count[1])};
  }

  Vector3d position(std::size_t i) const { return coordinates(i).cast<double>().matrix(); }

  void offer(std::size_t i, const Vector3d& p, int triangle) {
    if (triangle == samples_.triangle[i]) return;
    const auto t = triangles_.col(triangle);
    const Vector3d nearest =
        closest_point_on_triangle(p, vertices_.col(t[0]), vertices_.col(t[1]), vertices_.col(t[2]));
    const double distance = (p - nearest).norm();
    if (distance >= samples_.distance[i]) return;
    samples_.distance[i] = distance;
    samples_.triangle[i] = triangle;
  }

  // The 13 neighbours that a pass in that direction has just visited.
  void ask_neighbours(std::size_t i, int direction) {
    const Array3i at = coordinates(i);
    const Vector3d p = at.cast<double>().matrix();
    int last = kUnknown;
    for (int code = 14; code < 27; ++code) {  // 13 is the sample itself
      const Array3i step(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
      const Array3i from = at + direction * step;
      if ((from < 0).any() || (from >= samples_.count).any()) continue;
      const int triangle = samples_.triangle[samples_.index(from)];
      if (triangle != kUnknown && triangle != last) offer(i, p, triangle);
      last = triangle;
    }
  }

  const Eigen::Matrix3Xd& vertices_;
  const Eigen::Matrix3Xi& triangles_;
  Samples& samples_;
};

}  // namespace

void sample_signed_distance(const TriangleMesh& mesh, DistanceGrid& grid) {
  const Eigen::Matrix3Xd vertices = in_spacings(mesh, grid);
  VoxelBand band = voxel_band(vertices, mesh.triangles, grid.count);
  Samples samples = {grid.count, std::move(band.inside), std::move(band.triangle), {}};
  Propagation(vertices, mesh.triangles, samples).run();
  grid.samples.resize(samples.distance.size());
  for (std::size_t i = 0; i < samples.distance.size(); ++i) {
    const double distance = samples.distance[i] * grid.spacing;
    grid.samples[i] = static_cast<float>(samples.inside[i] ? -distance : distance);
  }
}

}  // namespace pliant
