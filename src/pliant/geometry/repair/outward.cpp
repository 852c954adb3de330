#include "pliant/geometry/repair/outward.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unsupported/Eigen/BVH>
#include <utility>
#include <vector>

#include "pliant/geometry/repair/orientation.h"
#include "pliant/geometry/search/box_tree.h"
#include "pliant/math/pi.h"
#include "pliant/math/shortest_turn.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kSamples = 40;     // triangles of a piece that are looked at
constexpr int kDirections = 12;  // rays to each side of one
constexpr std::size_t kMostNested = 2000;

struct SurfacePiece {
  std::vector<int> triangles;
  int inner_edges = 0;
  double volume = 0.0;
  Eigen::AlignedBox3d box;
  bool turned = false;

  bool closed() const { return 2 * inner_edges == 3 * static_cast<int>(triangles.size()); }
};

Vector3d area_vector(const TriangleMesh& mesh, int triangle) {
  const auto t = mesh.triangles.col(triangle);
  const Vector3d a = mesh.vertices.col(t[0]);
  return 0.5 * (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a);
}

Vector3d centroid(const TriangleMesh& mesh, int triangle) {
  const auto t = mesh.triangles.col(triangle);
  return (mesh.vertices.col(t[0]) + mesh.vertices.col(t[1]) + mesh.vertices.col(t[2])) / 3.0;
}

/// How far along a ray the first triangle is, for Eigen's BVMinimize.
struct FirstHit {
  using Scalar = double;
  const TriangleMesh& mesh;
  Vector3d from, along;
  int own;  // a triangle that does not count

  double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
    double enter = 0.0, leave = std::numeric_limits<double>::max();
    for (int k = 0; k < 3; ++k) {
      double low = (box.min()[k] - from[k]) / along[k], high = (box.max()[k] - from[k]) / along[k];
      if (low > high) std::swap(low, high);
      if (low > enter) enter = low;
      if (high < leave) leave = high;
    }
    return enter <= leave ? enter : std::numeric_limits<double>::max();
  }
  double minimumOnObject(int triangle) const {
    constexpr double kMiss = std::numeric_limits<double>::max();
    if (triangle == own) return kMiss;
    // Möller and Trumbore 1997.
    const auto t = mesh.triangles.col(triangle);
    const Vector3d a = mesh.vertices.col(t[0]);
    const Vector3d e1 = mesh.vertices.col(t[1]) - a, e2 = mesh.vertices.col(t[2]) - a;
    const Vector3d across = along.cross(e2);
    const double determinant = e1.dot(across);
    if (determinant == 0.0) return kMiss;
    const double u = (from - a).dot(across) / determinant;
    const Vector3d other = (from - a).cross(e1);
    const double v = along.dot(other) / determinant;
    const double at = e2.dot(other) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at > 0.0 ? at : kMiss;
  }
};

/// Evenly spread over the half sphere around +z.
std::vector<Vector3d> half_sphere() {
  std::vector<Vector3d> directions;
  for (int k = 0; k < kDirections; ++k) {
    const double z = (k + 0.5) / kDirections, r = std::sqrt(1.0 - z * z);
    const double angle = k * kPi * (3.0 - std::sqrt(5.0)) + 0.1;
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

class SideVote {
 public:
  explicit SideVote(const TriangleMesh& mesh) : mesh_(mesh), directions_(half_sphere()) {
    std::vector<Eigen::AlignedBox3d> boxes;
    Eigen::AlignedBox3d all;
    for (const auto t : mesh.triangles.colwise()) {
      Eigen::AlignedBox3d box(Vector3d(mesh.vertices.col(t[0])));
      box.extend(mesh.vertices.col(t[1])).extend(mesh.vertices.col(t[2]));
      all.extend(box);
      boxes.push_back(box);
    }
    tree_ = make_box_tree(boxes);
    size_ = all.sizes().norm();
  }

  /// Positive where rays in front of the piece come farther than those behind it.
  double operator()(const SurfacePiece& piece) const {
    double all = 0.0;
    for (const int t : piece.triangles) all += area_vector(mesh_, t).norm();
    double sum = 0.0, passed = 0.0, next = 0.5;
    for (const int t : piece.triangles) {
      const double area = area_vector(mesh_, t).norm();
      passed += area;
      if (!(area > 0.0) || passed * kSamples < next * all) continue;
      sum += openness(t, 1.0) - openness(t, -1.0);
      next = std::floor(passed / all * kSamples) + 1.0;
    }
    return sum;
  }

 private:
  double openness(int triangle, double side) const {
    const Vector3d normal = side * area_vector(mesh_, triangle).normalized();
    const Eigen::Quaterniond turn = shortest_turn(Vector3d::UnitZ(), normal);
    double sum = 0.0;
    for (const Vector3d& direction : directions_) {
      FirstHit search{mesh_, centroid(mesh_, triangle), turn * direction, triangle};
      const double reach = Eigen::BVMinimize(tree_, search);
      sum += reach > 1e3 * size_ ? 1.0 : 0.5 * std::min(1.0, reach / size_);
    }
    return sum;
  }

  const TriangleMesh& mesh_;
  std::vector<Vector3d> directions_;
  BoxTree tree_;
  double size_;
};

std::vector<SurfacePiece> find_pieces(TriangleMesh& mesh) {
  const std::vector<TriangleNeighbours> pairs = triangle_neighbours(mesh);
  OrientationUnion sets(static_cast<int>(mesh.triangles.cols()));
  // Most triangles of most files turn the right way: those that agree come first. What contradicts
  // them then (a Möbius strip; edges at which parts meet that miss a triangle) stays as it is.
  for (const bool opposed : {false, true}) {
    for (const TriangleNeighbours& pair : pairs) {
      if (pair.opposed == opposed) sets.relate(pair.triangles[0], pair.triangles[1], opposed);
    }
  }
  orient_by_majority(sets, mesh);
  std::map<int, std::size_t> number;
  std::vector<SurfacePiece> pieces;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto [entry, is_new] = number.emplace(sets.root(t), pieces.size());
    if (is_new) pieces.emplace_back();
    SurfacePiece& piece = pieces[entry->second];
    piece.triangles.push_back(t);
    for (const int v : mesh.triangles.col(t)) {
      piece.box.extend(Vector3d(mesh.vertices.col(v)));
    }
  }
  for (const TriangleNeighbours& pair : pairs) {
    ++pieces[number.at(sets.root(pair.triangles[0]))].inner_edges;
  }
  for (SurfacePiece& piece : pieces) {
    for (const int t : piece.triangles) {
      piece.volume += (centroid(mesh, t) - piece.box.center()).dot(area_vector(mesh, t)) / 3.0;
    }
  }
  return pieces;
}

/// The closed piece whose box is the smallest around that of pieces[k], and not its own.
int nest_of(const std::vector<SurfacePiece>& pieces, std::size_t k) {
  int nest = -1;
  for (std::size_t j = 0; j < pieces.size(); ++j) {
    const Eigen::AlignedBox3d& box = pieces[j].box;
    const bool is_around = (box.min().array() < pieces[k].box.min().array()).all() &&
                           (box.max().array() > pieces[k].box.max().array()).all();
    if (j == k || !pieces[j].closed() || !is_around) continue;
    if (nest < 0 || box.volume() < pieces[nest].box.volume()) nest = static_cast<int>(j);
  }
  return nest;
}

void choose_closed(std::vector<SurfacePiece>& pieces) {
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return pieces[a].box.volume() > pieces[b].box.volume();
  });
  for (const std::size_t k : order) {
    if (!pieces[k].closed()) continue;
    const int nest = pieces.size() <= kMostNested ? nest_of(pieces, k) : -1;
    pieces[k].turned = nest < 0 ? pieces[k].volume < 0.0 : pieces[nest].turned;
  }
}

int count_shells(const TriangleMesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  int shells = static_cast<int>(mesh.vertices.cols());
  for (const auto t : mesh.triangles.colwise()) {
    for (int k = 1; k < 3; ++k) {
      const int a = root(t[0]), b = root(t[k]);
      if (a == b) continue;
      parent[std::max(a, b)] = std::min(a, b);
      --shells;
    }
  }
  return shells;
}

}  // namespace

int turn_outward(TriangleMesh& mesh) {
  std::vector<SurfacePiece> pieces = find_pieces(mesh);
  choose_closed(pieces);
  const bool any_open = std::any_of(pieces.begin(), pieces.end(),
                                    [](const SurfacePiece& piece) { return !piece.closed(); });
  if (any_open) {
    const SideVote vote(mesh);
    for (SurfacePiece& piece : pieces) {
      if (!piece.closed()) piece.turned = vote(piece) < 0.0;
    }
  }
  for (const SurfacePiece& piece : pieces) {
    if (!piece.turned) continue;
    for (const int t : piece.triangles) std::swap(mesh.triangles(1, t), mesh.triangles(2, t));
  }
  return count_shells(mesh);
}

}  // namespace pliant
