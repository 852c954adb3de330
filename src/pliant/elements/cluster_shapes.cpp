#include "pliant/elements/cluster_shapes.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/elements/coloring.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

void check_stiffness(const std::string& where, double stiffness) {
  if (std::isfinite(stiffness) && stiffness >= 0.0) return;
  throw InputError(fmt::format("{}: stiffness is {} 1/s^2, but must be at least 0 and finite",
                               where, stiffness));
}

void check(const std::string& where, const Cluster& cluster, const Positions& rest,
           const Eigen::VectorXd& masses) {
  check_stiffness(where, cluster.stiffness);
  if (cluster.particles.empty()) {
    throw InputError(where + " has no particles; leave it out");
  }
  for (int i : cluster.particles) {
    if (i < 0 || i >= rest.cols()) {
      throw InputError(
          fmt::format("{} names particle {} outside [0, {}]", where, i, rest.cols() - 1));
    }
    if (!rest.col(i).allFinite() || !positive(masses[i])) {
      throw InputError(fmt::format(
          "{}: particle {} rests at ({}, {}, {}) m with mass {} kg; needs a finite position and a "
          "positive mass",
          where, i, rest(0, i), rest(1, i), rest(2, i), masses[i]));
    }
  }
  std::vector<int> sorted = cluster.particles;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    throw InputError(fmt::format("{} names particle {} twice; name it once", where, *twice));
  }
}

bool is_straight(const Eigen::Matrix3d& spread) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[1] <= 1e-12 * eigen.eigenvalues()[2];
}

}  // namespace

ClusterShapes::ClusterShapes(const std::string& name, const Positions& rest,
                             const Eigen::VectorXd& masses, const std::vector<Cluster>& clusters) {
  if (masses.size() != rest.cols()) {
    throw InputError(fmt::format("{}: {} masses for {} particles; give one each", name,
                                 masses.size(), rest.cols()));
  }
  std::vector<int> particles, first_of = {0};
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    check(fmt::format("{} {}", name, c), clusters[c], rest, masses);
    add(rest, masses, clusters[c]);
    first_of.push_back(members());
  }
  for (const Member& member : members_) particles.push_back(member.particle);
  Coloring coloring = color_elements(particles, first_of, static_cast<int>(rest.cols()));
  order_ = std::move(coloring.order);
  begins_ = std::move(coloring.begins);
}

void ClusterShapes::add(const Positions& rest, const Eigen::VectorXd& masses,
                        const Cluster& cluster) {
  Shape shape{members(), 0, 0.0, cluster.stiffness, false};
  for (int i : cluster.particles) {
    members_.push_back({i, masses[i], Eigen::Vector3d::Zero()});
    shape.mass += masses[i];
  }
  shape.end = members();
  const Eigen::Vector3d middle = center(shape, rest);
  double largest = 0.0;
  for (int i : cluster.particles) largest = std::max(largest, rest.col(i).cwiseAbs().maxCoeff());
  // Coincident particles differ by round-off only: that is no shape.
  const double round_off = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  for (int k = shape.begin; k < shape.end; ++k) {
    Member& member = members_[static_cast<std::size_t>(k)];
    const Eigen::Vector3d offset = rest.col(member.particle) - middle;
    if (offset.norm() > round_off) member.rest = offset;
  }
  shape.straight = is_straight(spread(shape));
  shapes_.push_back(shape);
}

void ClusterShapes::set_stiffness(int cluster, double stiffness) {
  if (cluster < 0 || cluster >= size()) {
    throw InputError(fmt::format("cluster {} is outside [0, {}]", cluster, size() - 1));
  }
  check_stiffness(fmt::format("cluster {}", cluster), stiffness);
  shapes_[static_cast<std::size_t>(cluster)].stiffness = stiffness;
}

Eigen::Vector3d ClusterShapes::center(const Shape& shape, const Positions& x) const {
  const Eigen::Vector3d origin = x.col(member(shape.begin).particle);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = shape.begin; k < shape.end; ++k) {
    sum += member(k).mass * (x.col(member(k).particle) - origin);
  }
  return origin + sum / shape.mass;
}

Eigen::Matrix3d ClusterShapes::moment(const Shape& shape, const Positions& x,
                                      const Eigen::Vector3d& center) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int k = shape.begin; k < shape.end; ++k) {
    const Member& m = member(k);
    sum += m.mass * (x.col(m.particle) - center) * m.rest.transpose();
  }
  return sum;
}

Eigen::Matrix3d ClusterShapes::spread(const Shape& shape) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int k = shape.begin; k < shape.end; ++k) {
    sum += member(k).mass * member(k).rest * member(k).rest.transpose();
  }
  return sum;
}

}  // namespace pliant
