#include "pliant/models/viscoelastic/cluster_plan.h"

#include <algorithm>
#include <cmath>

#include "pliant/geometry/meshing/spaced_points.h"
#include "pliant/geometry/search/point_hash.h"

namespace pliant {
namespace {

constexpr int kBisections = 12;

Positions columns(const Positions& x, const std::vector<int>& among) {
  Positions chosen(3, static_cast<Eigen::Index>(among.size()));
  for (std::size_t k = 0; k < among.size(); ++k) {
    chosen.col(static_cast<Eigen::Index>(k)) = x.col(among[k]);
  }
  return chosen;
}

}  // namespace

std::vector<int> spaced_subset(const Positions& x, const std::vector<int>& among,
                               double separation) {
  if (!(separation > 0.0)) return among;
  SpacedPoints spaced(separation);
  std::vector<int> chosen;
  for (int i : among) {
    if (spaced.keep(x.col(i))) chosen.push_back(i);
  }
  return chosen;
}

double separation_for(const Positions& x, const std::vector<int>& among, double fraction,
                      double largest) {
  const double wanted = std::max(1.0, fraction * static_cast<double>(among.size()));
  const auto too_many = [&](double separation) {
    return static_cast<double>(spaced_subset(x, among, separation).size()) > wanted;
  };
  if (fraction >= 1.0) return 0.0;
  if (too_many(largest)) return largest;
  double low = 0.0, high = largest;
  for (int k = 0; k < kBisections; ++k) {
    const double middle = 0.5 * (low + high);
    (too_many(middle) ? low : high) = middle;
  }
  return high;
}

std::vector<std::vector<int>> groups_about(const Positions& x, const std::vector<int>& centers,
                                           const std::vector<int>& among, double radius) {
  PointHash hash;
  hash.build(columns(x, among), radius);
  std::vector<std::vector<int>> groups(centers.size());
  for (std::size_t c = 0; c < centers.size(); ++c) {
    const Eigen::Vector3d center = x.col(centers[c]);
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
    hash.for_each_near(Eigen::AlignedBox3d(center - reach, center + reach), [&](int k) {
      const int i = among[static_cast<std::size_t>(k)];
      if ((x.col(i) - center).norm() <= radius) groups[c].push_back(i);
    });
    std::sort(groups[c].begin(), groups[c].end());
  }
  return groups;
}

}  // namespace pliant
