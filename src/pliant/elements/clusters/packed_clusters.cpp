#include "pliant/elements/clusters/packed_clusters.h"

#include <cstddef>
#include <cstring>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kGrain = 512;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

Eigen::Vector4d padded(const Eigen::Vector3d& v, double last) { return {v[0], v[1], v[2], last}; }

using Quad __attribute__((vector_size(32))) = double;

/// Σ (x − x_first) (m q, m)ᵀ over members [first, last), 4 x 4 by columns. From the first member,
/// so that no digits are lost far from the origin.
PLIANT_WIDEST void sum_members(const double* x, const double* loads, const int* particles,
                               int first, int last, double* sums) {
  Quad origin, place, sum[4] = {};
  std::memcpy(&origin, x + 4 * particles[first], sizeof origin);
  for (int m = first; m < last; ++m) {
    std::memcpy(&place, x + 4 * particles[m], sizeof place);
    place -= origin;
    const double* load = loads + 4 * static_cast<std::ptrdiff_t>(m);
    for (int k = 0; k < 4; ++k) sum[k] += load[k] * place;
  }
  std::memcpy(sums, sum, sizeof sum);
}

/// Σ k m (x_cm + R q − x) over pulls [first, last) of the particle at `x`.
PLIANT_WIDEST void sum_pulls(const double* x, const double* pulls, const int* clusters, int first,
                             int last, const double* motions, double* force) {
  Quad own, motion[4], sum = {};
  std::memcpy(&own, x, sizeof own);
  for (int n = first; n < last; ++n) {
    std::memcpy(motion, motions + 16 * static_cast<std::ptrdiff_t>(clusters[n]), sizeof motion);
    const double* pull = pulls + 4 * static_cast<std::ptrdiff_t>(n);
    const Quad turned = pull[0] * motion[0] + pull[1] * motion[1] + pull[2] * motion[2];
    sum += pull[3] * (motion[3] - own) + turned;
  }
  std::memcpy(force, &sum, sizeof sum);
}

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

void PackedClusters::gather(int begin, int end, Eigen::Vector3d* centers,
                            Eigen::Matrix3d* moments) const {
  constexpr int kSums = 16;
  double sums[kSums];
  for (int c = begin; c < end; ++c) {
    const int first = begins_[at(c)];
    sum_members(x_.front().data(), loads_.front().data(), particles_.data(), first,
                begins_[at(c) + 1], sums);
    const Eigen::Map<const Eigen::Matrix4d> all(sums);
    moments[c - begin] = all.topLeftCorner<3, 3>();
    centers[c - begin] =
        x_[at(particles_[at(first)])].head<3>() + masses_[at(c)] * all.topRightCorner<3, 1>();
  }
}

void PackedClusters::add_forces(int begin, int end, const std::vector<Motion>& motions,
                                Forces& f) const {
  Eigen::Vector4d sum;
  for (int i = begin; i < end; ++i) {
    sum_pulls(x_[at(i)].data(), pulls_.front().data(), clusters_.data(), shares_[at(i)],
              shares_[at(i) + 1], motions.front().data(), sum.data());
    f.col(i) += sum.head<3>();
  }
}

}  // namespace pliant
