#include "pliant/elements/clusters/cluster_sweep.h"

#include <algorithm>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"

namespace pliant {
namespace {

constexpr int kFitGrain = 16, kMoveGrain = 128;

std::size_t index_of(int k) { return static_cast<std::size_t>(k); }

Eigen::Vector3d goal_of(const ClusterSet::Motion& motion, const Eigen::Vector3d& rest) {
  return motion.topLeftCorner<3, 3>() * rest + motion.topRightCorner<3, 1>();
}

/// d_k, of the members that take part [m].
double deformation(const ClusterShapes& shapes, int cluster, const ClusterSet::Motion& motion,
                   const Positions& x) {
  const ClusterShapes::Shape& shape = shapes.shape(cluster);
  double sum = 0.0;
  for (int k = shape.begin; k < shape.end; ++k) {
    const ClusterShapes::Member& m = shapes.member(k);
    if (m.weight > 0.0) sum += (goal_of(motion, m.rest) - x.col(m.particle)).norm();
  }
  return sum;
}

}  // namespace

void ClusterSweep::prepare(const ClusterSet& set, const Eigen::VectorXd& inverse_mass) {
  const ClusterShapes& shapes = set.shapes();
  groups_.clear();
  motions_.assign(index_of(set.size()), ClusterSet::Motion::Zero());
  weights_.assign(index_of(set.size()), 1.0);
  parts_.setZero(inverse_mass.size());
  extent_ = 0.0;
  // By colours, whose clusters share no particle, so that a group has few that share one.
  std::vector<int> used;
  std::vector<std::size_t> ends;
  for (std::size_t color = 0; color + 1 < shapes.begins().size(); ++color) {
    for (int n = shapes.begins()[color]; n < shapes.begins()[color + 1]; ++n) {
      const int cluster = shapes.order()[index_of(n)];
      if (shapes.shape(cluster).mass > 0.0) used.push_back(cluster);
    }
    ends.push_back(used.size());
  }
  for (const int cluster : used) {
    for (int k = shapes.shape(cluster).begin; k < shapes.shape(cluster).end; ++k) {
      const ClusterShapes::Member& m = shapes.member(k);
      if (m.weight == 0.0) continue;
      extent_ += m.rest.norm();
      if (inverse_mass[m.particle] > 0.0) parts_[m.particle] = m.weight;
    }
  }
  if (order_.groups > 0) {
    ends.clear();
    const auto count = static_cast<std::size_t>(order_.groups);
    for (std::size_t g = 1; g <= count; ++g) ends.push_back(g * used.size() / count);
  }
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (end == begin) continue;
    const auto first = used.begin();
    add_group(
        set, {first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end)},
        inverse_mass);
    begin = end;
  }
}

void ClusterSweep::add_group(const ClusterSet& set, std::vector<int> clusters,
                             const Eigen::VectorXd& inverse_mass) {
  const ClusterShapes& shapes = set.shapes();
  Group group;
  std::vector<std::pair<int, Goal>> all;
  for (const int cluster : clusters) {
    for (int k = shapes.shape(cluster).begin; k < shapes.shape(cluster).end; ++k) {
      const ClusterShapes::Member& m = shapes.member(k);
      if (m.weight > 0.0 && inverse_mass[m.particle] > 0.0) {
        all.push_back({m.particle, {cluster, m.rest}});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [particle, goal] : all) {
    if (group.particles.empty() || group.particles.back() != particle) {
      group.particles.push_back(particle);
      group.begins.push_back(static_cast<int>(group.goals.size()));
    }
    group.goals.push_back(goal);
  }
  group.begins.push_back(static_cast<int>(group.goals.size()));
  group.clusters = std::move(clusters);
  groups_.push_back(std::move(group));
}

void ClusterSweep::fit(const ClusterSet& set, const Group& group, const Positions& x) {
  // All of them at once go through faster loops.
  const std::vector<ClusterSet::Motion>* all = groups_.size() == 1 ? &set.fits(x) : nullptr;
  parallel_for(0, static_cast<int>(group.clusters.size()), kFitGrain, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      const int c = group.clusters[index_of(n)];
      motions_[index_of(c)] = all != nullptr ? (*all)[index_of(c)] : set.fit(c, x);
      if (order_.by_deformation)
        weights_[index_of(c)] = deformation(set.shapes(), c, motions_[index_of(c)], x);
    }
  });
}

void ClusterSweep::move(const Group& group, Positions& x) const {
  parallel_for(0, static_cast<int>(group.particles.size()), kMoveGrain, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double weight = 0.0;
      for (int k = group.begins[index_of(n)]; k < group.begins[index_of(n) + 1]; ++k) {
        const Goal& goal = group.goals[index_of(k)];
        const double own = weights_[index_of(goal.cluster)];
        sum += own * goal_of(motions_[index_of(goal.cluster)], goal.rest);
        weight += own;
      }
      // Where no cluster is deformed each particle is at its goal.
      if (weight > 0.0) x.col(group.particles[index_of(n)]) = sum / weight;
    }
  });
}

void ClusterSweep::iterate(const ClusterSet& set, Positions& x) {
  for (const Group& group : groups_) {
    fit(set, group, x);
    move(group, x);
  }
}

double ClusterSweep::strain(const ClusterSet& set, const Positions& x) const {
  if (extent_ == 0.0) return 0.0;
  const std::vector<ClusterSet::Motion>& motions = set.fits(x);
  const double sum = parallel_sum(0, set.size(), kFitGrain, [&](int c) {
    return set.shapes().shape(c).mass > 0.0 ? deformation(set.shapes(), c, motions[index_of(c)], x)
                                            : 0.0;
  });
  return sum / extent_;
}

}  // namespace pliant
