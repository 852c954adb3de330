#include "pliant/effects/strain_limit/tethers.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

/// A row of particles, a metre apart.
Particles row(int count) {
  Positions x = Positions::Zero(3, count);
  for (int i = 0; i < count; ++i) x(0, i) = i;
  return Particles(x, Eigen::VectorXd::Ones(count));
}

std::vector<ClothEdge> chain(int count) {
  std::vector<ClothEdge> edges;
  for (int i = 0; i + 1 < count; ++i) edges.push_back({i, i + 1, 1.0});
  return edges;
}

TEST(Tethers, HoldEachParticleWithinItsWayFromWhatIsFixed) {
  Particles p = row(5);
  p.fix(0);
  Tethers tethers(chain(5), 5, 1.1);
  tethers.follow(p, {});
  ASSERT_EQ(tethers.size(), 4);
  p.x.row(0) *= 1.5;
  tethers.reset_multipliers();
  tethers.relax(p.inverse_mass, p.x);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(p.x(0, i), 1.1 * i, 1e-14);
  Forces f = Forces::Zero(3, 5);
  tethers.add_forces(f);
  // x moves by mobility x force.
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(f(0, i), 1.1 * i - 1.5 * i, 1e-14);
}

TEST(Tethers, LeaveAloneWhatIsNear) {
  Particles p = row(5);
  p.fix(0);
  Tethers tethers(chain(5), 5, 1.0);
  tethers.follow(p, {});
  p.x.row(0) *= 0.9;
  const Positions before = p.x;
  tethers.relax(p.inverse_mass, p.x);
  EXPECT_EQ(p.x, before);
}

TEST(Tethers, TakeTheShorterPath) {
  // Around a loop of six edges the ends are three apart, not five.
  std::vector<ClothEdge> edges = chain(6);
  edges.push_back({0, 5, 1.0});
  Particles p = row(6);
  p.fix(0);
  Tethers tethers(edges, 6, 1.0);
  tethers.follow(p, {});
  tethers.relax(p.inverse_mass, p.x);
  EXPECT_EQ(p.x(0, 5), 1.0);
  EXPECT_EQ(p.x(0, 4), 2.0);
  EXPECT_EQ(p.x(0, 3), 3.0);
}

TEST(Tethers, FollowWhatIsFixedAndReleased) {
  Particles p = row(5);
  Tethers tethers(chain(5), 5, 1.0);
  tethers.follow(p, {});
  EXPECT_EQ(tethers.size(), 0);
  p.fix(0);
  p.fix(4);
  tethers.follow(p, {});
  EXPECT_EQ(tethers.size(), 6) << "three between two places";
  p.release(0);
  tethers.follow(p, {});
  EXPECT_EQ(tethers.size(), 4);
}

TEST(Tethers, OfManyPlacesTheNearestCounts) {
  Particles p = row(11);
  for (int i = 0; i < 11; i += 2) p.fix(i);
  Tethers tethers(chain(11), 11, 1.0);
  tethers.follow(p, {});
  EXPECT_EQ(tethers.size(), 5);
}

}  // namespace
}  // namespace pliant
