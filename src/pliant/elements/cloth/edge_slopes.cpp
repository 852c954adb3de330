#include "pliant/elements/cloth/edge_slopes.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

// Rings of triangles around an edge, at the most.
constexpr int kMostRings = 4;
// Least eigenvalue, where coordinates are of unit variance, from which on vertices tell all
// quadratics apart; an edge between regular triangles has 0.7 or more.
constexpr double kWellPosed = 0.05;
// Below it they do not tell a quadratic at all.
constexpr double kUnknown = 1e-6;
// What a slope may be wrong by of curvature times the edge's length, without any correction.
constexpr double kExactEnough = 1e-5;
// Height of a sliver at an edge over that of the triangle beside it, at the most.
constexpr double kSliver = 0.1;
// How much it matters that a slope errs for cubics, beside how much its weights are changed.
// Without that, far vertices made narrow strips a sixth too stiff.
constexpr double kCubics = 10.0;
constexpr int kGrain = 64;

/// Triangles about an edge, laid flat: its middle is the origin, x runs along it and y into the
/// first triangle.
class Unfolding {
 public:
  Unfolding(const TriangleMesh& mesh, const MeshSides& sides, int edge)
      : mesh_(mesh), sides_(sides) {
    const int first = sides.triangles[static_cast<std::size_t>(edge)][0];
    const auto& edges = sides.opposite[static_cast<std::size_t>(first)];
    const auto k = static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
    const int from = mesh.triangles((k + 1) % 3, first), to = mesh.triangles((k + 2) % 3, first);
    length_ = (mesh.vertices.col(to) - mesh.vertices.col(from)).norm();
    Flat flat;
    flat.triangle = first;
    flat.corners[static_cast<std::size_t>((k + 1) % 3)] = {-0.5 * length_, 0.0};
    flat.corners[static_cast<std::size_t>((k + 2) % 3)] = {0.5 * length_, 0.0};
    flat.corners[static_cast<std::size_t>(k)] =
        third(from, {-0.5 * length_, 0.0}, to, {0.5 * length_, 0.0}, mesh.triangles(k, first), 1.0);
    add(flat);
    if (sides.triangles[static_cast<std::size_t>(edge)][1] >= 0) unfold(0, k);
  }

  /// Adds the neighbours of all that is there; false where there are none.
  bool grow() {
    const std::size_t count = flats_.size();
    for (std::size_t f = 0; f < count; ++f) {
      for (int k = 0; k < 3; ++k) unfold(f, k);
    }
    return flats_.size() > count;
  }

  struct Flat {
    int triangle = 0;
    std::array<Eigen::Vector2d, 3> corners;
  };
  const std::vector<Flat>& flats() const { return flats_; }
  const std::vector<int>& vertices() const { return vertices_; }
  const std::vector<Eigen::Vector2d>& places() const { return places_; }
  double length() const { return length_; }  ///< of the edge [m]
  std::size_t number(int vertex) const {
    const auto at = std::find(vertices_.begin(), vertices_.end(), vertex);
    return static_cast<std::size_t>(at - vertices_.begin());
  }

 private:
  /// Where the third corner lies, on the left of p to q (`side` 1) or on the right (-1).
  Eigen::Vector2d third(int from, const Eigen::Vector2d& p, int to, const Eigen::Vector2d& q,
                        int corner, double side) const {
    const Eigen::Vector3d a = mesh_.vertices.col(from);
    const Eigen::Vector3d along = mesh_.vertices.col(to) - a,
                          offset = mesh_.vertices.col(corner) - a;
    const double squared = along.squaredNorm();
    const Eigen::Vector2d d = q - p, left(-d.y(), d.x());
    return p + along.dot(offset) / squared * d + side * along.cross(offset).norm() / squared * left;
  }

  void add(const Flat& flat) {
    flats_.push_back(flat);
    for (int k = 0; k < 3; ++k) {
      const int vertex = mesh_.triangles(k, flat.triangle);
      if (number(vertex) < vertices_.size()) continue;
      vertices_.push_back(vertex);
      places_.push_back(flat.corners[static_cast<std::size_t>(k)]);
    }
  }

  /// What lies beyond the side opposite to corner k of a triangle.
  void unfold(std::size_t number, int k) {
    const Flat own = flats_[number];
    const int edge =
        sides_.opposite[static_cast<std::size_t>(own.triangle)][static_cast<std::size_t>(k)];
    const auto& both = sides_.triangles[static_cast<std::size_t>(edge)];
    const int other = both[0] == own.triangle ? both[1] : both[0];
    if (other < 0) return;
    for (const Flat& flat : flats_) {
      if (flat.triangle == other) return;
    }
    const int p = (k + 1) % 3, q = (k + 2) % 3;
    const int from = mesh_.triangles(p, own.triangle), to = mesh_.triangles(q, own.triangle);
    const Eigen::Vector2d at = own.corners[static_cast<std::size_t>(p)];
    const Eigen::Vector2d end = own.corners[static_cast<std::size_t>(q)];
    Flat flat;
    flat.triangle = other;
    for (int c = 0; c < 3; ++c) {
      const int vertex = mesh_.triangles(c, other);
      flat.corners[static_cast<std::size_t>(c)] =
          vertex == from ? at : (vertex == to ? end : third(from, at, to, end, vertex, -1.0));
    }
    add(flat);
  }

  const TriangleMesh& mesh_;
  const MeshSides& sides_;
  double length_;
  std::vector<Flat> flats_;
  std::vector<int> vertices_;
  std::vector<Eigen::Vector2d> places_;
};

/// dΦ_c/dy of the three linear shape functions.
Eigen::Vector3d rises(const std::array<Eigen::Vector2d, 3>& p) {
  const Eigen::Vector2d a = p[1] - p[0], b = p[2] - p[0];
  const double twice = a.x() * b.y() - a.y() * b.x();
  return {(b.x() - a.x()) / twice, -b.x() / twice, a.x() / twice};
}

/// -du/dy of the triangles at the edge, each by the height of the other, so that what bends across
/// the edge alone is met; a sliver beside a triangle that is none has no say. Weights of the
/// vertices that are there so far.
Eigen::VectorXd own_slope(const Unfolding& about, const TriangleMesh& mesh) {
  const auto& flats = about.flats();
  const auto height = [&](std::size_t t) {
    double result = 0.0;
    for (const auto& corner : flats[t].corners) result = std::max(result, std::abs(corner.y()));
    return result;
  };
  double shares[2] = {1.0, 0.0};
  if (flats.size() == 2) {
    const double first = height(0), second = height(1);
    shares[0] = second / (first + second);
    if (first < kSliver * second) shares[0] = 0.0;
    if (second < kSliver * first) shares[0] = 1.0;
    shares[1] = 1.0 - shares[0];
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(about.places().size()));
  for (std::size_t t = 0; t < flats.size(); ++t) {
    const double share = shares[t];
    const Eigen::Vector3d rise = rises(flats[t].corners);
    for (int k = 0; k < 3; ++k) {
      const std::size_t v = about.number(mesh.triangles(k, flats[t].triangle));
      weights[static_cast<Eigen::Index>(v)] -= share * rise[k];
    }
  }
  return weights;
}

using Quadratics = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// x², xy and y² at the places.
Quadratics quadratics_at(const Eigen::Matrix2Xd& places) {
  Quadratics result(places.cols(), 3);
  result.col(0) = places.row(0).array().square();
  result.col(1) = places.row(0).array() * places.row(1).array();
  result.col(2) = places.row(1).array().square();
  return result;
}

Eigen::Matrix2Xd matrix_of(const std::vector<Eigen::Vector2d>& places) {
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(places.size()));
  for (std::size_t k = 0; k < places.size(); ++k) {
    result.col(static_cast<Eigen::Index>(k)) = places[k];
  }
  return result;
}

/// x³, x²y, xy² and y³ at the places.
Eigen::Matrix<double, Eigen::Dynamic, 4> cubics_at(const Eigen::Matrix2Xd& places) {
  const Quadratics quadratics = quadratics_at(places);
  Eigen::Matrix<double, Eigen::Dynamic, 4> result(places.cols(), 4);
  for (int k = 0; k < 3; ++k) {
    result.col(k) = quadratics.col(k).array() * places.row(0).transpose().array();
  }
  result.col(3) = quadratics.col(2).array() * places.row(1).transpose().array();
  return result;
}

/// Corrects the weights of a slope, as little as will do, so that it is exact for quadratics.
class SlopeCorrection {
 public:
  explicit SlopeCorrection(const std::vector<Eigen::Vector2d>& all) {
    const Eigen::Matrix2Xd places = matrix_of(all);
    const Eigen::Matrix2d spread = places * places.transpose() / double(places.cols());
    // In coordinates of unit variance no shape of the triangles matters.
    at_ = spread.llt().matrixL().solve(places);
    nearness_ = (0.5 + at_.colwise().squaredNorm().array()).inverse().transpose();
    quadratics_ = quadratics_at(at_);
    linear_.resize(at_.cols(), 3);
    linear_ << Eigen::VectorXd::Ones(at_.cols()), at_.transpose();
    const Eigen::Matrix<double, 3, Eigen::Dynamic> weighted =
        linear_.transpose() * nearness_.asDiagonal();
    rest_ = quadratics_ - linear_ * (weighted * linear_).ldlt().solve(weighted * quadratics_);
    eigen_.compute(rest_.transpose() * nearness_.asDiagonal() * rest_);
  }

  bool is_well_posed() const { return eigen_.eigenvalues()[0] >= kWellPosed; }

  /// Those of quadratics then add up to nothing, as far as vertices tell them; those of linear
  /// functions stay what they are.
  void apply(Eigen::VectorXd& weights) const {
    if (is_well_posed()) {
      apply_with_cubics(weights);
    } else {
      apply_alone(weights);
    }
  }

 private:
  void apply_alone(Eigen::VectorXd& weights) const {
    Eigen::Vector3d along = eigen_.eigenvectors().transpose() * (quadratics_.transpose() * weights);
    for (int k = 0; k < 3; ++k) {
      const double value = eigen_.eigenvalues()[k];
      along[k] = value > kUnknown ? along[k] / value : 0.0;
    }
    weights -= nearness_.asDiagonal() * (rest_ * (eigen_.eigenvectors() * along));
  }

  /// The change d that makes 1/2 dᵀ D d + 1/2 m |Cᵀ (w + d)|² least, with D the inverse of nearness
  /// and C the cubics, where Bᵀ d is what linear functions and quadratics need.
  void apply_with_cubics(Eigen::VectorXd& weights) const {
    const auto cubics = cubics_at(at_);
    const Eigen::MatrixXd near = nearness_.asDiagonal();
    const Eigen::Matrix<double, Eigen::Dynamic, 4> weighted = near * cubics;
    const Eigen::Matrix4d sum =
        Eigen::Matrix4d::Identity() / kCubics + cubics.transpose() * weighted;
    // (D + m C Cᵀ)⁻¹, by Woodbury's identity.
    const Eigen::MatrixXd inverse = near - weighted * sum.ldlt().solve(weighted.transpose());
    Eigen::VectorXd change = -kCubics * (inverse * (cubics * (cubics.transpose() * weights)));
    Eigen::MatrixXd needs(at_.cols(), 6);
    needs << linear_, quadratics_;
    Eigen::VectorXd missing = -needs.transpose() * change;
    missing.tail<3>() -= quadratics_.transpose() * weights;
    const Eigen::MatrixXd moved = inverse * needs;
    change += moved * (needs.transpose() * moved).ldlt().solve(missing);
    weights += change;
  }

  Eigen::Matrix2Xd at_;
  Eigen::VectorXd nearness_;
  Quadratics linear_, quadratics_, rest_;  // `rest_`: of quadratics, at right angles to linear ones
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen_;
};

EdgeSlope slope_of(const TriangleMesh& mesh, const MeshSides& sides, int edge) {
  Unfolding about(mesh, sides, edge);
  const bool is_inner = about.flats().size() > 1;
  Eigen::VectorXd weights = own_slope(about, mesh);
  const double wrong =
      (quadratics_at(matrix_of(about.places())).transpose() * weights).norm() / about.length();
  if (!is_inner || wrong > kExactEnough) {
    const int least = is_inner ? 1 : 2;
    for (int ring = 1; ring <= kMostRings && about.grow(); ++ring) {
      if (ring >= least && SlopeCorrection(about.places()).is_well_posed()) break;
    }
    const Eigen::Index known = weights.size();
    weights.conservativeResize(static_cast<Eigen::Index>(about.places().size()));
    weights.tail(weights.size() - known).setZero();
    SlopeCorrection(about.places()).apply(weights);
  }
  EdgeSlope slope;
  const double least = 1e-13 * weights.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < about.vertices().size(); ++k) {
    const double weight = weights[static_cast<Eigen::Index>(k)];
    if (std::abs(weight) <= least) continue;
    slope.vertices.push_back(about.vertices()[k]);
    slope.weights.push_back(weight);
  }
  return slope;
}

}  // namespace

MeshSides find_sides(const TriangleMesh& mesh) {
  MeshSides sides;
  sides.edges = edges(mesh);
  const auto& all = sides.edges.vertices;
  sides.triangles.resize(all.size(), {-1, -1});
  sides.opposite.resize(static_cast<std::size_t>(mesh.triangles.cols()));
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles((k + 1) % 3, t), b = mesh.triangles((k + 2) % 3, t);
      const std::array<int, 2> side = {std::min(a, b), std::max(a, b)};
      const auto e = std::lower_bound(all.begin(), all.end(), side) - all.begin();
      sides.opposite[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] =
          static_cast<int>(e);
      auto& both = sides.triangles[static_cast<std::size_t>(e)];
      both[both[0] < 0 ? 0 : 1] = t;
    }
  }
  return sides;
}

std::vector<EdgeSlope> edge_slopes(const TriangleMesh& mesh, const MeshSides& sides) {
  std::vector<EdgeSlope> slopes(sides.edges.vertices.size());
  parallel_for(0, static_cast<int>(slopes.size()), kGrain, [&](int begin, int end) {
    for (int e = begin; e < end; ++e)
      slopes[static_cast<std::size_t>(e)] = slope_of(mesh, sides, e);
  });
  return slopes;
}

}  // namespace pliant
