#include "pliant/core/body/surface_bends.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pliant/geometry/search/point_hash.h"

namespace pliant {
namespace {

// Neighbours that a bend is found from: all within so many distances of the nearest one.
constexpr double kNear = 2.5;
constexpr std::size_t kLeastNeighbors = 3;
// Neighbours whose normals are farther away than 45 degrees are on the other side of an edge.
constexpr double kSameSide = 0.7;
// A surface whose normals turn by so much more or less than they should bends in no one way.
constexpr double kTolerance = 0.02, kNoise = 1e-3;
// It counts as flat where it turns by less than this over the reach [rad], and is known no farther
// than it turns by kMostTurn.
constexpr double kFlat = 1e-3, kMostTurn = 0.5;
// How far a bend is followed, in distances of the nearest point: places of several points then meet
// rather than leave something between them.
constexpr double kReach = 1.5;

/// Σ |K d − e|² over neighbours is least, d and e being the offsets and turns in the tangent plane;
/// K is symmetric.
template <class Neighbors>
Eigen::Matrix2d fitted(const Neighbors& neighbors, const Eigen::Matrix<double, 3, 2>& tangents) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const auto& neighbor : neighbors) {
    const Eigen::Vector2d d = tangents.transpose() * neighbor.offset;
    const Eigen::Vector2d e = tangents.transpose() * neighbor.turn;
    Eigen::Matrix<double, 2, 3> rows;
    rows << d[0], d[1], 0.0, 0.0, d[0], d[1];
    a += rows.transpose() * rows / d.squaredNorm();
    b += rows.transpose() * e / d.squaredNorm();
  }
  const Eigen::Vector3d k = a.fullPivLu().solve(b);
  Eigen::Matrix2d curvature;
  curvature << k[0], k[1], k[1], k[2];
  return curvature;
}

Eigen::Matrix<double, 3, 2> tangents_of(const Eigen::Vector3d& normal) {
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  return tangents;
}

Eigen::Matrix<double, 4, 3> gradient_of(const Eigen::Matrix<double, 3, 4>& corners) {
  Eigen::Matrix4d places;
  places << corners, Eigen::RowVector4d::Ones();
  return places.inverse().leftCols<3>();
}

}  // namespace

SurfaceBends::Bend SurfaceBends::bend_of(const Eigen::Vector3d& normal,
                                         const std::vector<Neighbor>& neighbors, double nearest) {
  Bend bend;
  bend.normal = normal;
  bend.nearest = nearest;
  if (neighbors.size() < kLeastNeighbors) return bend;
  const Eigen::Matrix<double, 3, 2> tangents = tangents_of(normal);
  const Eigen::Matrix2d curvature = fitted(neighbors, tangents);
  if (!curvature.allFinite()) return bend;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(curvature);
  const double most = eigen.eigenvalues().cwiseAbs().maxCoeff();
  for (const Neighbor& neighbor : neighbors) {
    const Eigen::Vector2d d = tangents.transpose() * neighbor.offset;
    const double off = (curvature * d - tangents.transpose() * neighbor.turn).norm();
    if (off > kTolerance * most * d.norm() + kNoise) return bend;
  }
  const double reach = std::min(kReach * nearest, kMostTurn / std::max(most, 1e-300));
  for (int k = 0; k < 2; ++k) {
    const double bent = eigen.eigenvalues()[k];
    if (bent * reach < kFlat) continue;
    const Eigen::Vector3d along = tangents * eigen.eigenvectors().col(k);
    bend.curvature += bent * along * along.transpose();
    bend.inverse += 1.0 / bent * along * along.transpose();
    bend.reach = reach;
  }
  return bend;
}

SurfaceBends::SurfaceBends(const Eigen::Matrix3Xd& normals, const EmbeddedPoints& carried,
                           const Positions& rest) {
  const int count = carried.size();
  if (normals.cols() != count || count == 0) return;
  Eigen::Matrix3Xd points(3, count);
  carried.positions(rest, points);
  const Eigen::AlignedBox3d all(Eigen::Vector3d(points.rowwise().minCoeff()),
                                Eigen::Vector3d(points.rowwise().maxCoeff()));
  const double cell = all.diagonal().norm() / std::sqrt(static_cast<double>(count));
  if (!(cell > 0.0)) return;
  PointHash hash;
  hash.build(points, cell);
  std::vector<Neighbor> neighbors;
  bends_.reserve(static_cast<std::size_t>(count));
  gradient_ = gradient_of(rest(Eigen::all, carried.particles().col(0)));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d here = points.col(i);
    const auto for_each_within = [&](double distance, const auto& use) {
      const Eigen::Vector3d half = Eigen::Vector3d::Constant(distance);
      hash.for_each_near({here - half, here + half}, [&](int j) {
        const Eigen::Vector3d offset = points.col(j) - here;
        if (j != i && offset.norm() <= distance) use(j, offset);
      });
    };
    double nearest = 4.0 * cell;
    for_each_within(nearest, [&](int, const Eigen::Vector3d& offset) {
      nearest = std::min(nearest, offset.norm());
    });
    neighbors.clear();
    for_each_within(kNear * nearest, [&](int j, const Eigen::Vector3d& offset) {
      if (normals.col(j).dot(normals.col(i)) < kSameSide) return;
      neighbors.push_back({offset, normals.col(j) - normals.col(i)});
    });
    const Bend bend = bend_of(normals.col(i), neighbors, nearest);
    const double rise = 0.5 * bend.curvature.norm() * bend.reach * bend.reach;
    most_rise_ = std::max(most_rise_, rise);
    bends_.push_back(bend);
  }
}

Eigen::Vector4d SurfaceBends::farthest(int point, const EmbeddedPoints& carried, const Positions& x,
                                       const Eigen::Vector3d& direction) const {
  const Bend& bend = bends_[static_cast<std::size_t>(point)];
  const Eigen::Vector4d own = carried.weights().col(point);
  if (bend.reach == 0.0) return own;
  // The body's map is p = F q + ..., F = Σ x_k ∇w_k: against `direction` p reaches as far as q does
  // against Fᵀ direction.
  const Eigen::Matrix3d f = map_of(point, carried, x);
  const Eigen::Vector3d against = f.transpose() * direction;
  const double facing = -against.dot(bend.normal);
  if (!(facing > kSameSide * against.norm())) return own;
  // To where the normal is against the direction, on an arc: by the turn K t = tan θ on the tangent
  // plane, by θ along the arc.
  Eigen::Vector3d arc = -1.0 / facing * (bend.inverse * against);
  const double tangent = (bend.curvature * arc).norm();
  if (!(tangent > 0.0)) return own;
  double turn = std::atan(tangent);
  arc *= turn / tangent;
  const double share = std::min(1.0, bend.reach / arc.norm());
  arc *= share;
  turn *= share;
  const double sine = std::sin(turn) / turn, drop = (1.0 - std::cos(turn)) / (turn * turn);
  const Eigen::Vector3d move = sine * arc - drop * arc.dot(bend.curvature * arc) * bend.normal;
  return own + gradient_ * move;
}

Eigen::Vector3d SurfaceBends::along_bends(int point, const EmbeddedPoints& carried,
                                          const Positions& x, const Eigen::Vector3d& normal,
                                          const Eigen::Vector3d& u) const {
  const Bend& bend = bends_[static_cast<std::size_t>(point)];
  const Eigen::Matrix3d f = map_of(point, carried, x);
  const Eigen::Vector3d against = f.transpose() * normal;
  const bool faces = -against.dot(bend.normal) > kSameSide * against.norm();
  if (bend.reach == 0.0 || !faces) return Eigen::Vector3d::Zero();
  const Eigen::Matrix3d bent = bend.curvature * bend.inverse;  // projects onto those directions
  if (bent.trace() > 1.5) return u;
  Eigen::Index most;
  bent.diagonal().maxCoeff(&most);
  const Eigen::Vector3d way = f * bent.col(most);
  const Eigen::Vector3d along = (way - normal * normal.dot(way)).normalized();
  return along * along.dot(u);
}

}  // namespace pliant
