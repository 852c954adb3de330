#include "pliant/elements/clusters/cluster_shapes.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
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
  if (!cluster.rest.empty() && cluster.rest.size() != cluster.particles.size()) {
    throw InputError(fmt::format("{} has {} rest positions for {} particles; give one each or none",
                                 where, cluster.rest.size(), cluster.particles.size()));
  }
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
  double largest = 0.0;
  const Eigen::Vector3d origin = rest.col(cluster.particles.front());
  for (std::size_t k = 0; k < cluster.particles.size(); ++k) {
    const int i = cluster.particles[k];
    // From the first member, so that no digits are lost far from the origin.
    const Eigen::Vector3d at =
        cluster.rest.empty() ? Eigen::Vector3d(rest.col(i) - origin) : cluster.rest[k];
    members_.push_back({i, masses[i], at, masses[i], 1.0});
    largest = std::max(largest, cluster.rest.empty() ? rest.col(i).cwiseAbs().maxCoeff()
                                                     : at.cwiseAbs().maxCoeff());
  }
  shape.end = members();
  shapes_.push_back(shape);
  rebalance(size() - 1);
  // Coincident particles differ by round-off only: that is no shape.
  const double round_off = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  for (int k = shape.begin; k < shape.end; ++k) {
    Member& member = members_[static_cast<std::size_t>(k)];
    if (!(member.rest.norm() > round_off)) member.rest.setZero();
  }
}

void ClusterShapes::set_member(int number, double weight, const Eigen::Vector3d& rest) {
  Member& member = members_[static_cast<std::size_t>(number)];
  member.weight = weight;
  member.mass = weight * member.full_mass;
  member.rest = rest;
}

void ClusterShapes::rebalance(int cluster) {
  Shape& shape = shapes_[static_cast<std::size_t>(cluster)];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = shape.begin; k < shape.end; ++k) sum += member(k).mass * member(k).rest;
  measure(shape);
  if (shape.mass == 0.0) return;
  const Eigen::Vector3d middle = sum / shape.mass;
  for (int k = shape.begin; k < shape.end; ++k) {
    members_[static_cast<std::size_t>(k)].rest -= middle;
  }
  measure(shape);
}

void ClusterShapes::measure(Shape& shape) {
  shape.mass = 0.0;
  for (int k = shape.begin; k < shape.end; ++k) shape.mass += member(k).mass;
  shape.straight = is_straight(spread(shape));
}

void ClusterShapes::save(StateArchive& numbers) const {
  for (const Shape& shape : shapes_) numbers.write(shape.stiffness);
  for (const Member& member : members_) {
    numbers.write(member.weight);
    numbers.write_all(member.rest);
  }
}

void ClusterShapes::load(StateArchive& numbers) {
  for (Shape& shape : shapes_) shape.stiffness = numbers.read();
  for (Member& member : members_) {
    member.weight = numbers.read();
    member.mass = member.weight * member.full_mass;
    numbers.read_all(member.rest);
  }
  for (Shape& shape : shapes_) measure(shape);
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
  return shape.mass > 0.0 ? Eigen::Vector3d(origin + sum / shape.mass) : origin;
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

int ClusterShapes::first_inside_out(const Positions& x) const {
  // Of the determinant of three equal moments: less is flat, and has no inside.
  constexpr double kFlat = 1e-6;
  // Of that at rest: a strain that only just passes through a plane is not meant.
  constexpr double kShare = 0.01;
  for (int c = 0; c < size(); ++c) {
    const Shape& own = shape(c);
    if (own.stiffness <= 0.0 || own.mass <= 0.0) continue;
    const Eigen::Matrix3d at_rest = spread(own);
    const double volume = at_rest.determinant(), third = at_rest.trace() / 3.0;
    if (volume < kFlat * third * third * third) continue;
    if (moment(own, x, center(own, x)).determinant() < -kShare * volume) return c;
  }
  return -1;
}

}  // namespace pliant
