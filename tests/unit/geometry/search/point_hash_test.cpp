#include "pliant/geometry/search/point_hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "support/random.h"

namespace pliant {
namespace {

std::vector<int> near(const PointHash& hash, const Eigen::AlignedBox3d& box) {
  std::vector<int> found;
  hash.for_each_near(box, [&](int i) { found.push_back(i); });
  return found;
}

Eigen::AlignedBox3d box_at(const Eigen::Vector3d& center, double half) {
  return {center.array() - half, center.array() + half};
}

TEST(PointHash, FindsAllWithinABoxAndNoneFarFromIt) {
  Random random(1);
  for (const double shift : {0.0, 1000.0}) {
    const double cell = 0.1;
    Positions points = random.positions(2000, 1.0);
    points.array() += shift;
    PointHash hash;
    hash.build(points, cell);
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d center = random.vector(1.2).array() + shift;
      // From less than a cell to more cells than points.
      const Eigen::AlignedBox3d box = box_at(center, 0.02 * std::pow(1.03, trial));
      const std::vector<int> found = near(hash, box);
      const std::set<int> once(found.begin(), found.end());
      EXPECT_EQ(once.size(), found.size());
      for (int i = 0; i < points.cols(); ++i) {
        const double distance =
            (points.col(i).cwiseMax(box.min()).cwiseMin(box.max()) - points.col(i))
                .cwiseAbs()
                .maxCoeff();
        if (distance == 0.0) {
          EXPECT_TRUE(once.count(i) > 0);
        } else if (distance > cell) {
          EXPECT_TRUE(once.count(i) == 0);
        }
      }
    }
  }
}

TEST(PointHash, LeavesOutWhatIsNotFinite) {
  Positions points = Positions::Zero(3, 5);
  points(0, 1) = std::nan("");
  points(1, 2) = std::numeric_limits<double>::infinity();
  points(2, 3) = -1e300;
  PointHash hash;
  hash.build(points, 0.01);
  EXPECT_EQ(near(hash, box_at(Eigen::Vector3d::Zero(), 0.1)), (std::vector<int>{0, 4}));
  EXPECT_EQ(near(hash, box_at(Eigen::Vector3d::Zero(), 1e308)), (std::vector<int>{0, 4}));
  EXPECT_TRUE(near(hash, box_at(Eigen::Vector3d::Constant(std::nan("")), 0.1)).empty());
  EXPECT_TRUE(near(hash, box_at(Eigen::Vector3d::Constant(1e200), 0.1)).empty());
}

TEST(PointHash, MayBeEmptyAndBuiltAnew) {
  PointHash hash;
  const Eigen::AlignedBox3d box = box_at(Eigen::Vector3d::Zero(), 1.0);
  EXPECT_TRUE(near(hash, box).empty());
  hash.build(Positions::Zero(3, 3), 0.1);
  EXPECT_EQ(near(hash, box).size(), 3u);
  hash.build(Positions(3, 0), 0.1);
  EXPECT_TRUE(near(hash, box).empty());
}

}  // namespace
}  // namespace pliant
