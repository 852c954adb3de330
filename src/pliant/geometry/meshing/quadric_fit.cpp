#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pliant/geometry/patch/patch_fit.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kNormalWeight = 0.03;  // of a gradient's error against a value's in edge lengths
constexpr double kRidge = 1e-5;  // keeps the second-order part small where samples leave it open
constexpr std::size_t kFewSamples = 20;

/// At a height of one edge length over the base, the surface is off Q = 0 by this share of it.
/// Small: Q = 0 is the shape. Not smaller: where the surface crosses the base, curvature would
/// jump.
constexpr double kSoftness = 1e-4;

using Row = Eigen::Matrix<double, 1, 10>;

/// Rows of the monomials' derivatives.
Eigen::Matrix<double, 3, 10> derivatives(const Vector3d& p) {
  const double x = p[0], y = p[1], z = p[2];
  Eigen::Matrix<double, 3, 10> rows;
  rows << 2 * x, 0, 0, y, 0, z, 1, 0, 0, 0,  //
      0, 2 * y, 0, x, z, 0, 0, 1, 0, 0,      //
      0, 0, 2 * z, 0, y, x, 0, 0, 1, 0;
  return rows;
}

/// Fits the quadrics of a base's edges one by one.
class EdgeFit {
 public:
  EdgeFit(const TriangleMesh& base, const std::vector<FitSample>& samples)
      : base_(base),
        edges_(edges(base)),
        samples_(samples),
        of_triangle_(static_cast<std::size_t>(base.triangles.cols())),
        of_vertex_(static_cast<std::size_t>(base.vertices.cols())) {
    for (std::size_t s = 0; s < samples.size(); ++s) {
      of_triangle_[static_cast<std::size_t>(samples[s].triangle)].push_back(s);
    }
    normals_.resize(3, base.triangles.cols());
    for (int t = 0; t < base.triangles.cols(); ++t) {
      const Vector3d a = corner(t, 0);
      normals_.col(t) = (corner(t, 1) - a).cross(corner(t, 2) - a).normalized();
      for (int k = 0; k < 3; ++k) {
        of_vertex_[static_cast<std::size_t>(base.triangles(k, t))].push_back(t);
      }
    }
  }

  const Edges& all() const { return edges_; }

  /// With |grad Q| = 1 / length at the surface, in coordinates about the edge's middle. The larger
  /// `ridge`, the less it is curved.
  Quadric fit(std::size_t edge, double ridge = kRidge) const {
    const Vector3d middle = 0.5 * (end(edge, 0) + end(edge, 1));
    const double scale = length(edge);
    Eigen::Matrix<double, 12, 12> system = Eigen::Matrix<double, 12, 12>::Zero();
    Eigen::Matrix<double, 12, 1> right = Eigen::Matrix<double, 12, 1>::Zero();
    auto normal_matrix = system.topLeftCorner<10, 10>();
    double total = 0.0;
    for (const std::size_t s : samples_about(edge)) {
      const Vector3d p = (samples_[s].point - middle) / scale;
      const double weight = 1.0 / (0.05 + distance_to(edge, samples_[s].point) / scale);
      const Row row = monomials(p);
      const auto slopes = derivatives(p);
      const double by_slope = weight * kNormalWeight * kNormalWeight;
      normal_matrix += weight * row.transpose() * row + by_slope * slopes.transpose() * slopes;
      right.head<10>() -= by_slope * slopes.transpose() * samples_[s].normal;
      total += weight;
    }
    normal_matrix.diagonal().head<6>().array() += ridge * ridge * total;
    for (int k = 0; k < 2; ++k) {
      const Row row = monomials((end(edge, k) - middle) / scale);
      system.block<1, 10>(10 + k, 0) = row * total;
      system.block<10, 1>(0, 10 + k) = row.transpose() * total;
    }
    const Eigen::Matrix<double, 12, 1> solution = system.fullPivLu().solve(right);
    return placed(solution.head<10>(), middle, scale);
  }

  /// The plane through the edge that halves the angle of its triangles, as flat() in fit()'s units.
  Quadric flat(std::size_t edge) const {
    const Vector3d across = bisector(edge);
    Quadric plane = Quadric::Zero();
    plane.segment<3>(6) = -across / length(edge);
    plane[9] = across.dot(end(edge, 0)) / length(edge);
    return plane;
  }

  double length(std::size_t edge) const { return (end(edge, 1) - end(edge, 0)).norm(); }

 private:
  Vector3d corner(int triangle, int k) const {
    return base_.vertices.col(base_.triangles(k, triangle));
  }
  Vector3d end(std::size_t edge, int k) const {
    return base_.vertices.col(edges_.vertices[edge][static_cast<std::size_t>(k)]);
  }

  std::vector<int> triangles_beside(std::size_t edge) const {
    std::vector<int> result;
    const auto& [a, b] = edges_.vertices[edge];
    for (const int t : of_vertex_[static_cast<std::size_t>(a)]) {
      if ((base_.triangles.col(t).array() == b).any()) result.push_back(t);
    }
    return result;
  }

  Vector3d bisector(std::size_t edge) const {
    Vector3d sum = Vector3d::Zero();
    for (const int t : triangles_beside(edge)) sum += normals_.col(t);
    return sum.normalized();
  }

  std::vector<std::size_t> samples_of(const std::vector<int>& triangles) const {
    std::vector<std::size_t> result;
    for (const int t : triangles) {
      const auto& some = of_triangle_[static_cast<std::size_t>(t)];
      result.insert(result.end(), some.begin(), some.end());
    }
    return result;
  }

  std::vector<std::size_t> samples_about(std::size_t edge) const {
    std::vector<std::size_t> result = samples_of(triangles_beside(edge));
    if (result.size() >= kFewSamples) return result;
    std::vector<int> around;
    for (const int v : edges_.vertices[edge]) {
      const auto& fan = of_vertex_[static_cast<std::size_t>(v)];
      around.insert(around.end(), fan.begin(), fan.end());
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    return samples_of(around);
  }

  double distance_to(std::size_t edge, const Vector3d& p) const {
    const Vector3d along = end(edge, 1) - end(edge, 0);
    const double at = std::clamp(along.dot(p - end(edge, 0)) / along.squaredNorm(), 0.0, 1.0);
    return (p - end(edge, 0) - at * along).norm();
  }

  const TriangleMesh& base_;
  Edges edges_;
  const std::vector<FitSample>& samples_;
  std::vector<std::vector<std::size_t>> of_triangle_;
  std::vector<std::vector<int>> of_vertex_;
  Eigen::Matrix3Xd normals_;
};

/// Between which heights over their triangle its samples lie, 0 included [m].
struct HeightRange {
  double low = 0.0, high = 0.0;
};

std::vector<HeightRange> sample_heights(const TriangleMesh& base,
                                        const std::vector<FitSample>& samples) {
  std::vector<HeightRange> ranges(static_cast<std::size_t>(base.triangles.cols()));
  for (const FitSample& sample : samples) {
    const auto corners = base.triangles.col(sample.triangle);
    const Vector3d a = base.vertices.col(corners[0]);
    const Vector3d b = base.vertices.col(corners[1]), c = base.vertices.col(corners[2]);
    const double height = (b - a).cross(c - a).normalized().dot(sample.point - a);
    HeightRange& range = ranges[static_cast<std::size_t>(sample.triangle)];
    range.low = std::min(range.low, height);
    range.high = std::max(range.high, height);
  }
  return ranges;
}

/// Whether a patch stays where its samples are and does not fold, on a grid of points that is fine
/// enough to find its spikes.
bool is_tame(const PatchSurface& surface, int patch, double size, const HeightRange& range) {
  constexpr int kGrid = 16;
  constexpr double kBeyond = 0.03;  // of the size, by which it may leave the heights of its samples
  const auto corners = surface.body().base.triangles.col(patch);
  const auto& x = surface.body().base.vertices;
  const Vector3d a = x.col(corners[0]), b = x.col(corners[1]), c = x.col(corners[2]);
  const Vector3d up = (b - a).cross(c - a).normalized();
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; i + j <= kGrid; ++j) {
      const int k = kGrid - i - j;
      if (std::max({i, j, k}) == kGrid) continue;
      const Vector3d p = surface.point(patch, Vector3d(i, j, k) / kGrid);
      const double height = up.dot(p - a);
      if (height > range.high + kBeyond * size || height < range.low - kBeyond * size) return false;
      if (surface.normal(patch, p).dot(up) < 0.1) return false;
    }
  }
  return true;
}

double longest_edge(const TriangleMesh& mesh, int triangle) {
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int a = mesh.triangles(k, triangle), b = mesh.triangles((k + 1) % 3, triangle);
    longest = std::max(longest, (mesh.vertices.col(a) - mesh.vertices.col(b)).norm());
  }
  return longest;
}

std::size_t edge_index(const PatchBody& body, int triangle, int k) {
  std::array<int, 2> edge = {body.base.triangles(k, triangle),
                             body.base.triangles((k + 1) % 3, triangle)};
  if (edge[0] > edge[1]) std::swap(edge[0], edge[1]);
  const auto place = std::lower_bound(body.edges.begin(), body.edges.end(), edge);
  return static_cast<std::size_t>(place - body.edges.begin());
}

/// The edges of patches that are not tame.
std::vector<char> wild_edges(const PatchBody& body, const std::vector<HeightRange>& ranges) {
  const PatchSurface surface(body);
  std::vector<char> wild(body.edges.size(), 0);
  for (int t = 0; t < surface.patches(); ++t) {
    const HeightRange& range = ranges[static_cast<std::size_t>(t)];
    if (is_tame(surface, t, longest_edge(body.base, t), range)) continue;
    for (int k = 0; k < 3; ++k) wild[edge_index(body, t, k)] = 1;
  }
  return wild;
}

/// Leaves triangles flat that fit the samples better so: those of a box, say. An edge loses its
/// quadric where the triangles on both sides agree.
void drop_useless(PatchBody& body, const std::vector<FitSample>& samples, double steepness) {
  const PatchSurface surface(body);
  std::vector<double> gain(static_cast<std::size_t>(surface.patches()), 0.0);
  for (const FitSample& sample : samples) {
    const auto corners = body.base.triangles.col(sample.triangle);
    const Vector3d a = body.base.vertices.col(corners[0]);
    const Vector3d b = body.base.vertices.col(corners[1]), c = body.base.vertices.col(corners[2]);
    const double height = (b - a).cross(c - a).normalized().dot(sample.point - a);
    // F' = Q³ - height, and |grad Q| is about the steepness.
    const double off = std::cbrt(surface.value(sample.triangle, sample.point) + height) / steepness;
    gain[static_cast<std::size_t>(sample.triangle)] += height * height - off * off;
  }
  std::vector<char> useful(body.edges.size(), 0);
  for (int t = 0; t < surface.patches(); ++t) {
    if (gain[static_cast<std::size_t>(t)] <= 0.0) continue;
    for (int k = 0; k < 3; ++k) useful[edge_index(body, t, k)] = 1;
  }
  for (std::size_t e = 0; e < useful.size(); ++e) {
    if (useful[e] == 0) body.quadrics[e].setZero();
  }
}

}  // namespace

PatchBody fit_quadrics(const TriangleMesh& base, const std::vector<FitSample>& samples) {
  const EdgeFit fit(base, samples);
  PatchBody body;
  body.base = base;
  body.edges = fit.all().vertices;
  double mean_length = 0.0;
  for (std::size_t e = 0; e < body.edges.size(); ++e) mean_length += fit.length(e);
  mean_length /= static_cast<double>(body.edges.size());
  // Q = steepness * signed distance to the surface, so that Q³ at kSoftness lengths is a length.
  const double steepness = std::cbrt(mean_length) / (kSoftness * mean_length);
  for (std::size_t e = 0; e < body.edges.size(); ++e) {
    body.quadrics.push_back(steepness * fit.length(e) * fit.fit(e));
  }
  // What is wild becomes less and less curved, and flat at last, which may make a neighbour wild.
  constexpr int kCurved = 12, kRounds = 24;
  const std::vector<HeightRange> ranges = sample_heights(base, samples);
  for (int round = 1; round <= kRounds; ++round) {
    const std::vector<char> wild = wild_edges(body, ranges);
    if (std::find(wild.begin(), wild.end(), 1) == wild.end()) break;
    for (std::size_t e = 0; e < wild.size(); ++e) {
      if (wild[e] == 0) continue;
      const Quadric calmer =
          round > kCurved ? fit.flat(e) : fit.fit(e, kRidge * std::pow(10.0, 0.5 * round));
      body.quadrics[e] = steepness * fit.length(e) * calmer;
    }
  }
  drop_useless(body, samples, steepness);
  return body;
}

}  // namespace pliant
