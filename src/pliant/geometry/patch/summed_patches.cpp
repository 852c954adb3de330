#include "pliant/geometry/patch/summed_patches.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "pliant/geometry/search/nearest_triangle.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kNormalWeight = 0.2;  // of a normal's error against a place's in edge lengths
constexpr double kRidge = 1e-4;        // keeps the second-order part small where samples are few
constexpr double kSoftness = 1e-4;     // as fit_quadrics() has it
constexpr int kLevel = 16;             // of the points that are compared on a patch's edges

struct Frame {
  std::array<Vector3d, 3> corner;
  Vector3d normal, middle;
  double size;  // longest edge [m]
};

Frame frame_of(const TriangleMesh& base, int triangle) {
  Frame frame;
  for (int k = 0; k < 3; ++k) {
    frame.corner[static_cast<std::size_t>(k)] = base.vertices.col(base.triangles(k, triangle));
  }
  const auto& c = frame.corner;
  frame.normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  frame.middle = (c[0] + c[1] + c[2]) / 3.0;
  frame.size = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
  return frame;
}

double perturbation(const std::vector<Quadric>& quadrics, const Vector3d& p) {
  double sum = 0.0;
  for (const Quadric& quadric : quadrics) {
    const double q = std::max(value(quadric, p), 0.0);
    sum += q * q * q;
  }
  return sum;
}

double height(const std::vector<Quadric>& quadrics, const Frame& frame, const Vector3d& from) {
  // F' along the ray is perturbation - t: its first change of sign, then halved.
  constexpr int kScan = 48;
  const auto excess = [&](double t) { return perturbation(quadrics, from + t * frame.normal) - t; };
  double low = 0.0, high = 0.0;
  for (int k = 1; k <= kScan; ++k) {
    high = frame.size * k / kScan;
    if (excess(high) < 0.0) break;
    low = high;
  }
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0.0 ? high : low) = middle;
  }
  return low;
}

Vector3d over(const std::vector<Quadric>& quadrics, const Frame& frame, const Vector3d& at) {
  const Vector3d from = at[0] * frame.corner[0] + at[1] * frame.corner[1] + at[2] * frame.corner[2];
  return from + height(quadrics, frame, from) * frame.normal;
}

/// The quadric whose value is 0 and whose gradient is -normal at the samples, |gradient| 1.
Quadric quadric_of(const std::vector<const FitSample*>& samples, const Frame& frame) {
  Eigen::Matrix<double, 10, 10> matrix = Eigen::Matrix<double, 10, 10>::Zero();
  Quadric right = Quadric::Zero();
  for (const FitSample* sample : samples) {
    const Vector3d p = (sample->point - frame.middle) / frame.size;
    Quadric row;
    row << p[0] * p[0], p[1] * p[1], p[2] * p[2], p[0] * p[1], p[1] * p[2], p[2] * p[0], p, 1.0;
    matrix += row * row.transpose();
    for (int axis = 0; axis < 3; ++axis) {
      Quadric slope = Quadric::Zero();
      slope[axis] = 2.0 * p[axis];
      // xy, yz, zx are coefficients 3, 4, 5: of an axis and the next one, of the last and it.
      slope[3 + axis] = p[(axis + 1) % 3];
      slope[3 + (axis + 2) % 3] = p[(axis + 2) % 3];
      slope[6 + axis] = 1.0;
      constexpr double kSlopeWeight = 0.03 * 0.03;
      matrix += kSlopeWeight * slope * slope.transpose();
      right -= kSlopeWeight * sample->normal[axis] * slope;
    }
  }
  matrix.diagonal().head<6>().array() += kRidge * kRidge * static_cast<double>(samples.size());
  const Quadric local = matrix.fullPivLu().solve(right);
  return frame.size * placed(local, frame.middle, frame.size);
}

/// Groups of samples by place and normal: Lloyd's iterations from seeds that are far apart.
std::vector<std::vector<const FitSample*>> grouped(const std::vector<const FitSample*>& samples,
                                                   int groups, const Frame& frame) {
  using Place = Eigen::Matrix<double, 6, 1>;
  std::vector<Place> places;
  for (const FitSample* sample : samples) {
    Place place;
    place << (sample->point - frame.middle) / frame.size, kNormalWeight * sample->normal;
    places.push_back(place);
  }
  std::vector<Place> seeds = {places.front()};
  const auto nearest = [&](const Place& place) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < seeds.size(); ++k) {
      if ((place - seeds[k]).norm() < (place - seeds[best]).norm()) best = k;
    }
    return best;
  };
  while (static_cast<int>(seeds.size()) < groups) {
    const auto far = [&](const Place& p) { return (p - seeds[nearest(p)]).norm(); };
    seeds.push_back(*std::max_element(places.begin(), places.end(),
                                      [&](auto& a, auto& b) { return far(a) < far(b); }));
  }
  std::vector<std::vector<const FitSample*>> result;
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    result.assign(seeds.size(), {});
    std::vector<Place> sums(seeds.size(), Place::Zero());
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const std::size_t k = nearest(places[s]);
      result[k].push_back(samples[s]);
      sums[k] += places[s];
    }
    for (std::size_t k = 0; k < seeds.size(); ++k) {
      if (!result[k].empty()) seeds[k] = sums[k] / static_cast<double>(result[k].size());
    }
  }
  result.erase(std::remove_if(result.begin(), result.end(), [](auto& g) { return g.empty(); }),
               result.end());
  return result;
}

/// Squares of the distances along the normal from the samples over the triangle itself.
double misfit(const std::vector<Quadric>& quadrics, const Frame& frame,
              const std::vector<const FitSample*>& samples) {
  double sum = 0.0;
  for (const FitSample* sample : samples) {
    const double h = frame.normal.dot(sample->point - frame.corner[0]);
    const double off = height(quadrics, frame, sample->point - h * frame.normal) - h;
    sum += off * off;
  }
  return sum;
}

/// Vertices so far inwards that no sample lies below the triangles beside them by much.
TriangleMesh inset(const TriangleMesh& base, const std::vector<FitSample>& samples) {
  Eigen::VectorXd depth = Eigen::VectorXd::Zero(base.vertices.cols());
  for (const FitSample& sample : samples) {
    const Frame frame = frame_of(base, sample.triangle);
    const double below = -frame.normal.dot(sample.point - frame.corner[0]);
    for (int k = 0; k < 3; ++k) {
      double& own = depth[base.triangles(k, sample.triangle)];
      own = std::max(own, below);
    }
  }
  TriangleMesh moved = base;
  moved.vertices -= vertex_normals(base) * depth.asDiagonal();
  return moved;
}

/// The samples of each triangle, and those that neighbours share with it.
class SamplesAbout {
 public:
  SamplesAbout(const TriangleMesh& base, const std::vector<FitSample>& samples)
      : base_(base),
        of_triangle_(static_cast<std::size_t>(base.triangles.cols())),
        of_vertex_(static_cast<std::size_t>(base.vertices.cols())) {
    for (const FitSample& sample : samples) {
      of_triangle_[static_cast<std::size_t>(sample.triangle)].push_back(&sample);
      for (int k = 0; k < 3; ++k) {
        const int v = base.triangles(k, sample.triangle);
        of_vertex_[static_cast<std::size_t>(v)].push_back(&sample);
      }
    }
  }

  const std::vector<const FitSample*>& own(int triangle) const {
    return of_triangle_[static_cast<std::size_t>(triangle)];
  }

  /// Its own, and others over a margin about it.
  std::vector<const FitSample*> about(int triangle, const Frame& frame) const {
    constexpr double kReach = 0.65;  // of the longest edge, from the triangle's middle
    std::vector<const FitSample*> all = own(triangle);
    for (int k = 0; k < 3; ++k) {
      const int v = base_.triangles(k, triangle);
      for (const FitSample* sample : of_vertex_[static_cast<std::size_t>(v)]) {
        const Vector3d from = sample->point - frame.middle;
        const double across = (from - frame.normal.dot(from) * frame.normal).norm();
        if (sample->triangle != triangle && across < kReach * frame.size) all.push_back(sample);
      }
    }
    return all;
  }

 private:
  const TriangleMesh& base_;
  std::vector<std::vector<const FitSample*>> of_triangle_, of_vertex_;
};

/// Each patch as kLevel² triangles; neighbours share no vertex.
TriangleMesh separate_polygons(const SummedPatches& body) {
  std::vector<Vector3d> points;
  std::vector<Eigen::Vector3i> triangles;
  for (int t = 0; t < static_cast<int>(body.base.triangles.cols()); ++t) {
    // Rows of kLevel + 1, kLevel, ... 1 points.
    int first = static_cast<int>(points.size());
    for (int i = 0; i <= kLevel; ++i) {
      const int row = kLevel - i, next = first + row + 1;
      for (int j = 0; j <= row; ++j) {
        points.push_back(point(body, t, Vector3d(i, j, row - j) / kLevel));
        if (j < row) triangles.emplace_back(first + j, next + j, first + j + 1);
        if (j + 1 < row) triangles.emplace_back(next + j, next + j + 1, first + j + 1);
      }
      first = next;
    }
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    mesh.vertices.col(static_cast<Eigen::Index>(k)) = points[k];
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    mesh.triangles.col(static_cast<Eigen::Index>(k)) = triangles[k];
  }
  return mesh;
}

/// How far the patches beside an edge are apart, over points of it.
void measure_gaps(const SummedPatches& body, SummedReport& report) {
  const TriangleMesh& base = body.base;
  std::map<std::array<int, 2>, std::vector<Vector3d>> seen;
  double squares = 0.0;
  int count = 0;
  for (int t = 0; t < static_cast<int>(base.triangles.cols()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = base.triangles(k, t), b = base.triangles((k + 1) % 3, t);
      std::vector<Vector3d> own;
      for (int i = 0; i <= kLevel; ++i) {
        Vector3d at = Vector3d::Zero();
        at[k] = static_cast<double>(a < b ? kLevel - i : i) / kLevel;
        at[(k + 1) % 3] = 1.0 - at[k];
        own.push_back(point(body, t, at));
      }
      const auto [other, is_first] = seen.emplace(std::array{std::min(a, b), std::max(a, b)}, own);
      if (is_first) continue;
      for (std::size_t i = 0; i < own.size(); ++i) {
        const double gap = (own[i] - other->second[i]).norm();
        report.widest_gap = std::max(report.widest_gap, gap);
        squares += gap * gap;
        ++count;
      }
    }
  }
  report.rms_gap = std::sqrt(squares / std::max(count, 1));
}

}  // namespace

double value(const SummedPatches& body, int patch, const Vector3d& p) {
  const Frame frame = frame_of(body.base, patch);
  return perturbation(body.quadrics[static_cast<std::size_t>(patch)], p) -
         frame.normal.dot(p - frame.corner[0]);
}

Vector3d point(const SummedPatches& body, int patch, const Vector3d& barycentric) {
  return over(body.quadrics[static_cast<std::size_t>(patch)], frame_of(body.base, patch),
              barycentric);
}

SummedPatches fit_summed_patches(const TriangleMesh& base, const std::vector<FitSample>& samples,
                                 int each) {
  if (each < 1 || each > kMostPerturbations) {
    throw InputError(
        fmt::format("quadrics a patch are {}: allowed are [1, {}]", each, kMostPerturbations));
  }
  SummedPatches body;
  body.base = inset(base, samples);
  const SamplesAbout samples_about(base, samples);
  for (int t = 0; t < static_cast<int>(base.triangles.cols()); ++t) {
    const Frame frame = frame_of(body.base, t);
    const double steepness = std::cbrt(frame.size) / (kSoftness * frame.size);
    const auto& own = samples_about.own(t);
    const std::vector<const FitSample*> all = samples_about.about(t, frame);
    std::vector<Quadric> best;
    double least = misfit(best, frame, own);
    for (int count = 1; count <= each && !all.empty(); ++count) {
      std::vector<Quadric> some;
      for (const auto& group : grouped(all, count, frame)) {
        some.push_back(steepness * quadric_of(group, frame));
      }
      const double sum = misfit(some, frame, own);
      if (sum >= least) continue;
      least = sum;
      best = some;
    }
    body.quadrics.push_back(best);
  }
  return body;
}

SummedReport compare(const SummedPatches& body, const TriangleMesh& mesh) {
  SummedReport report;
  for (const auto& own : body.quadrics) report.quadrics += static_cast<int>(own.size());
  measure_gaps(body, report);
  const TriangleMesh polygons = separate_polygons(body);
  const NearestTriangle to_mesh(mesh), to_patches(polygons);
  double squares = 0.0;
  for (const auto p : polygons.vertices.colwise()) {
    const double distance = to_mesh(p).distance;
    squares += distance * distance;
    report.max_distance = std::max(report.max_distance, distance);
  }
  report.rms_distance = std::sqrt(squares / static_cast<double>(polygons.vertices.cols()));
  for (const auto v : mesh.vertices.colwise()) {
    report.max_distance = std::max(report.max_distance, to_patches(v).distance);
  }
  return report;
}

}  // namespace pliant
