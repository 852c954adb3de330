#include "cuda/elements/common_rest.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "pliant/elements/clusters/cluster_shapes.h"

namespace pliant {
namespace {

// Of the body's extent: shapes that differ by less are one, as far as single precision can tell.
constexpr double kSame = 1e-8;
constexpr double kQuantum = 1.0 / (1 << 29);

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// Puts shapes together along the members that they share; begins anew where nothing connects.
class Puzzle {
 public:
  Puzzle(const ClusterShapes& shapes, int particles) : shapes_(shapes) {
    rest_.setZero(3, particles);
    mass_.assign(at(particles), -1.0);
    begins_.assign(at(particles) + 1, 0);
    for (int k = 0; k < shapes.members(); ++k) ++begins_[at(shapes.member(k).particle) + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    holders_.resize(at(shapes.members()));
    std::vector<int> next = begins_;
    for (int c = 0; c < shapes.size(); ++c) {
      for (int k = shapes.shape(c).begin; k < shapes.shape(c).end; ++k) {
        holders_[at(next[at(shapes.member(k).particle)]++)] = c;
      }
    }
  }

  bool solve() {
    std::vector<bool> is_listed(at(shapes_.size()), false);
    std::deque<int> waiting;
    for (int first = 0; first < shapes_.size(); ++first) {
      if (is_listed[at(first)]) continue;
      is_listed[at(first)] = true;
      waiting.push_back(first);
      while (!waiting.empty()) {
        const int c = waiting.front();
        waiting.pop_front();
        if (!put(shapes_.shape(c))) return false;
        list_neighbors(shapes_.shape(c), is_listed, waiting);
      }
    }
    return true;
  }

  bool store(const std::vector<int>& place, int places, std::vector<Fixed>& rest,
             double& quantum) const {
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < rest_.cols(); ++i) {
      if (mass_[static_cast<std::size_t>(i)] >= 0.0) box.extend(rest_.col(i));
    }
    if (box.isEmpty()) return false;
    const double extent = std::max(box.sizes().maxCoeff(), 1e-30);
    if (!(worst_ <= kSame * extent)) return false;
    quantum = kQuantum * extent;
    rest.assign(at(places), Fixed{0, 0, 0, 0.0f});
    for (int i = 0; i < static_cast<int>(mass_.size()); ++i) {
      if (mass_[at(i)] < 0.0) continue;
      const Eigen::Vector3d quanta = (rest_.col(i) - box.center()) / quantum;
      const auto whole = [&](int k) { return static_cast<int>(std::lrint(quanta[k])); };
      rest[at(place[at(i)])] = {whole(0), whole(1), whole(2), static_cast<float>(mass_[at(i)])};
    }
    return true;
  }

 private:
  bool put(const ClusterShapes::Shape& shape) {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      if (mass_[at(m.particle)] < 0.0) continue;
      origin = rest_.col(m.particle) - m.rest;
      break;
    }
    for (int k = shape.begin; k < shape.end; ++k) {
      const ClusterShapes::Member& m = shapes_.member(k);
      double& mass = mass_[at(m.particle)];
      const Eigen::Vector3d here = origin + m.rest;
      if (mass < 0.0) {
        mass = m.mass;
        rest_.col(m.particle) = here;
      }
      if (mass != m.mass) return false;
      worst_ = std::max(worst_, (rest_.col(m.particle) - here).cwiseAbs().maxCoeff());
    }
    return true;
  }

  void list_neighbors(const ClusterShapes::Shape& shape, std::vector<bool>& is_listed,
                      std::deque<int>& waiting) const {
    for (int k = shape.begin; k < shape.end; ++k) {
      const int i = shapes_.member(k).particle;
      for (int h = begins_[at(i)]; h < begins_[at(i + 1)]; ++h) {
        const int other = holders_[at(h)];
        if (is_listed[at(other)]) continue;
        is_listed[at(other)] = true;
        waiting.push_back(other);
      }
    }
  }

  const ClusterShapes& shapes_;
  Eigen::Matrix3Xd rest_;
  std::vector<double> mass_;           // -1: not put yet
  std::vector<int> begins_, holders_;  // of particles: their clusters
  double worst_ = 0.0;                 // by which shapes differ [m]
};

}  // namespace

bool find_common_rest(const ClusterShapes& shapes, const std::vector<int>& place, int places,
                      std::vector<Fixed>& rest, double& quantum) {
  Puzzle puzzle(shapes, static_cast<int>(place.size()));
  return puzzle.solve() && puzzle.store(place, places, rest, quantum);
}

}  // namespace pliant
