#include "pliant/effects/strain_limit/tethers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

constexpr int kGrain = 256;
// Beyond so many separate places that are fixed or held, each particle is tied to the nearest
// alone.
constexpr std::size_t kMaxIslands = 4;
// In which it is found where a held anchor balances its tethers, some of which become slack.
constexpr int kYieldings = 3;

}  // namespace

Tethers::Tethers(const std::vector<ClothEdge>& edges, int particles, double max) : max_(max) {
  const auto n = static_cast<std::size_t>(particles);
  first_.assign(n + 1, 0);
  for (const ClothEdge& edge : edges) {
    ++first_[static_cast<std::size_t>(edge.i) + 1];
    ++first_[static_cast<std::size_t>(edge.j) + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  ends_.resize(2 * edges.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  const auto add = [&](int from, int to, double length) {
    ends_[static_cast<std::size_t>(next[static_cast<std::size_t>(from)]++)] = {to, length};
  };
  for (const ClothEdge& edge : edges) {
    add(edge.i, edge.j, edge.length);
    add(edge.j, edge.i, edge.length);
  }
  is_anchor_.assign(n, 0);
  pull_of_.assign(n, -1);
  begins_.assign(n + 1, 0);
}

std::vector<std::vector<int>> Tethers::islands() const {
  std::vector<std::vector<int>> islands;
  std::vector<char> is_seen(is_anchor_.size(), 0);
  for (std::size_t seed = 0; seed < is_anchor_.size(); ++seed) {
    if (!is_anchor_[seed] || is_seen[seed]) continue;
    std::vector<int> island = {static_cast<int>(seed)};
    is_seen[seed] = 1;
    for (std::size_t at = 0; at < island.size(); ++at) {
      const auto i = static_cast<std::size_t>(island[at]);
      for (int e = first_[i]; e < first_[i + 1]; ++e) {
        const auto other = static_cast<std::size_t>(ends_[static_cast<std::size_t>(e)].other);
        if (!is_anchor_[other] || is_seen[other]) continue;
        is_seen[other] = 1;
        island.push_back(static_cast<int>(other));
      }
    }
    islands.push_back(std::move(island));
  }
  return islands;
}

std::vector<Tethers::Path> Tethers::paths_from(const std::vector<int>& sources) const {
  std::vector<Path> paths(is_anchor_.size(), {std::numeric_limits<double>::infinity(), -1});
  using Step = std::pair<double, int>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (const int source : sources) {
    paths[static_cast<std::size_t>(source)] = {0.0, source};
    open.push({0.0, source});
  }
  while (!open.empty()) {
    const auto [length, particle] = open.top();
    open.pop();
    const auto i = static_cast<std::size_t>(particle);
    if (length > paths[i].length) continue;
    for (int e = first_[i]; e < first_[i + 1]; ++e) {
      const End& end = ends_[static_cast<std::size_t>(e)];
      Path& path = paths[static_cast<std::size_t>(end.other)];
      const double through = length + end.length;
      if (!(through < path.length)) continue;
      path = {through, paths[i].from};
      open.push({through, end.other});
    }
  }
  return paths;
}

void Tethers::tie(const std::vector<int>& sources) {
  const std::vector<Path> paths = paths_from(sources);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (is_anchor_[i] || paths[i].from < 0) continue;
    tethers_.push_back({static_cast<int>(i), paths[i].from, max_ * paths[i].length});
  }
}

void Tethers::follow(const Particles& particles, const std::vector<HeldVertex>& held) {
  bool changed = !(held == held_);
  if (changed) {
    held_ = held;
    std::fill(pull_of_.begin(), pull_of_.end(), -1);
    pulls_.clear();
    for (const HeldVertex& vertex : held_) {
      pull_of_[static_cast<std::size_t>(vertex.particle)] = static_cast<int>(pulls_.size());
      pulls_.push_back({vertex.particle, {}, {}, 0.0});
    }
  }
  for (std::size_t i = 0; i < is_anchor_.size(); ++i) {
    const char now = particles.is_fixed(static_cast<int>(i)) || pull_of_[i] >= 0 ? 1 : 0;
    changed |= now != is_anchor_[i];
    is_anchor_[i] = now;
  }
  if (!changed) return;
  tethers_.clear();
  const std::vector<std::vector<int>> fixed = islands();
  if (fixed.size() <= kMaxIslands) {
    for (const std::vector<int>& island : fixed) tie(island);
  } else {
    std::vector<int> all;
    for (const std::vector<int>& island : fixed)
      all.insert(all.end(), island.begin(), island.end());
    tie(all);
  }
  std::stable_sort(tethers_.begin(), tethers_.end(),
                   [](const Tether& a, const Tether& b) { return a.particle < b.particle; });
  std::fill(begins_.begin(), begins_.end(), 0);
  for (const Tether& tether : tethers_) ++begins_[static_cast<std::size_t>(tether.particle) + 1];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
}

void Tethers::reset_multipliers() {
  for (Tether& tether : tethers_) tether.force.setZero();
}

void Tethers::yield(const Eigen::VectorXd& mobility, Positions& x) {
  for (Pull& pull : pulls_) pull.start = x.col(pull.particle);
  for (int round = 0; round < kYieldings; ++round) {
    for (Pull& pull : pulls_) {
      // What holds it has its own turn, or is part of the mobility.
      pull.stiffness = 1.0 / mobility[pull.particle];
      pull.force = pull.stiffness * (pull.start - x.col(pull.particle));
    }
    for (const Tether& tether : tethers_) {
      const int p = pull_of_[static_cast<std::size_t>(tether.anchor)];
      const double own = mobility[tether.particle];
      if (p < 0 || own == 0.0) continue;
      const Eigen::Vector3d between = x.col(tether.particle) - x.col(tether.anchor);
      const double squared = between.squaredNorm();
      if (squared <= tether.length * tether.length) continue;
      const double length = std::sqrt(squared);
      Pull& pull = pulls_[static_cast<std::size_t>(p)];
      pull.force += (length - tether.length) / (length * own) * between;
      pull.stiffness += 1.0 / own;
    }
    for (const Pull& pull : pulls_) {
      if (mobility[pull.particle] == 0.0) continue;
      x.col(pull.particle) += pull.force / pull.stiffness;
    }
  }
}

void Tethers::balance(const Eigen::VectorXd& mobility, Positions& x) {
  for (Pull& pull : pulls_) pull.force.setZero();
  for (const Tether& tether : tethers_) {
    const int p = pull_of_[static_cast<std::size_t>(tether.anchor)];
    if (p >= 0) pulls_[static_cast<std::size_t>(p)].force += tether.last;
  }
  for (const Pull& pull : pulls_) {
    x.col(pull.particle) = pull.start + mobility[pull.particle] * pull.force;
  }
}

void Tethers::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (!pulls_.empty()) yield(mobility, x);
  parallel_for(0, static_cast<int>(begins_.size()) - 1, kGrain, [&](int begin, int end) {
    const auto last = static_cast<std::size_t>(begins_[static_cast<std::size_t>(end)]);
    for (auto t = static_cast<std::size_t>(begins_[static_cast<std::size_t>(begin)]); t < last;
         ++t) {
      Tether& tether = tethers_[t];
      tether.last.setZero();
      const Eigen::Vector3d between = x.col(tether.particle) - x.col(tether.anchor);
      const double squared = between.squaredNorm();
      if (squared <= tether.length * tether.length) continue;
      const double own = mobility[tether.particle], length = std::sqrt(squared);
      if (own == 0.0) continue;
      const Eigen::Vector3d pull = ((length - tether.length) / length) * between;
      tether.last = pull / own;
      tether.force += tether.last;
      x.col(tether.particle) -= pull;
    }
  });
  if (!pulls_.empty()) balance(mobility, x);
}

void Tethers::add_forces(Forces& f) const {
  for (const Tether& tether : tethers_) {
    f.col(tether.particle) -= tether.force;
    if (pull_of_[static_cast<std::size_t>(tether.anchor)] >= 0)
      f.col(tether.anchor) += tether.force;
  }
}

}  // namespace pliant
