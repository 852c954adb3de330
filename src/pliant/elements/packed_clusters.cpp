#include "pliant/elements/packed_clusters.h"

#include "pliant/core/parallel.h"

namespace pliant {
namespace {

constexpr int kGrain = 4096;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

Eigen::Vector4d padded(const Eigen::Vector3d& v, double last) { return {v[0], v[1], v[2], last}; }

}  // namespace

void PackedClusters::build(const ClusterShapes& shapes, int particles) {
  begins_.assign(at(shapes.size()) + 1, 0);
  masses_.resize(at(shapes.size()));
  loads_.resize(at(shapes.members()));
  particles_.resize(at(shapes.members()));
  pulls_.resize(at(shapes.members()));
  clusters_.resize(at(shapes.members()));
  shares_.assign(at(particles) + 1, 0);
  for (int k = 0; k < shapes.members(); ++k) ++shares_[at(shapes.member(k).particle) + 1];
  for (std::size_t i = 1; i < shares_.size(); ++i) shares_[i] += shares_[i - 1];
  std::vector<int> next = shares_;
  for (int c = 0; c < shapes.size(); ++c) {
    const ClusterShapes::Shape& shape = shapes.shape(c);
    begins_[at(c)] = shape.begin;
    begins_[at(c) + 1] = shape.end;
    masses_[at(c)] = shape.mass > 0.0 ? 1.0 / shape.mass : 0.0;
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes.member(k);
      const std::size_t place = at(next[at(m.particle)]++);
      loads_[at(k)] = padded(m.mass * m.rest, m.mass);
      particles_[at(k)] = m.particle;
      pulls_[place] = shape.stiffness * loads_[at(k)];
      clusters_[place] = c;
    }
  }
}

void PackedClusters::set_positions(const Positions& x) {
  const int n = static_cast<int>(x.cols());
  x_.resize(at(n));
  parallel_for(0, n, kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) x_[at(i)] = padded(x.col(i), 0.0);
  });
}

void PackedClusters::gather(int cluster, Eigen::Vector3d& center, Eigen::Matrix3d& moment) const {
  const std::size_t first = at(begins_[at(cluster)]), last = at(begins_[at(cluster) + 1]);
  // From the first member, so that no digits are lost far from the origin.
  const Eigen::Vector4d origin = x_[at(particles_[first])];
  Eigen::Vector4d sum0 = Eigen::Vector4d::Zero(), sum1 = sum0, sum2 = sum0, sum3 = sum0;
  for (std::size_t m = first; m != last; ++m) {
    const Eigen::Vector4d from = x_[at(particles_[m])] - origin;
    const Eigen::Vector4d& load = loads_[m];
    sum0 += load[0] * from;
    sum1 += load[1] * from;
    sum2 += load[2] * from;
    sum3 += load[3] * from;
  }
  moment << sum0.head<3>(), sum1.head<3>(), sum2.head<3>();
  center = origin.head<3>() + masses_[at(cluster)] * sum3.head<3>();
}

Eigen::Vector3d PackedClusters::force(int particle, const std::vector<Motion>& motions) const {
  const Eigen::Vector4d x = x_[at(particle)];
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  const std::size_t last = at(shares_[at(particle) + 1]);
  for (std::size_t n = at(shares_[at(particle)]); n != last; ++n) {
    const Motion& motion = motions[at(clusters_[n])];
    const Eigen::Vector4d& pull = pulls_[n];
    const Eigen::Vector4d turned =
        pull[0] * motion.col(0) + pull[1] * motion.col(1) + pull[2] * motion.col(2);
    sum += pull[3] * (motion.col(3) - x) + turned;
  }
  return sum.head<3>();
}

}  // namespace pliant
