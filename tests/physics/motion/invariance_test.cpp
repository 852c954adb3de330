// The same scene gives the same result: on any number of threads bit for bit, and wherever it
// stands.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "support/random.h"
#include "support/worlds/worlds.h"

namespace pliant::invariance_test {
namespace {

class Threads : public EverySolver {
 protected:
  void TearDown() override { set_threads(1); }

  /// Positions and velocities after `steps` on `count` threads.
  Eigen::MatrixXd result(int count, int nodes, int steps) const {
    set_threads(count);
    ClothScene s;
    s.grid = {0.3, 0.3, nodes, nodes};
    s.solver = GetParam();
    s.time_step = is_explicit(GetParam()) ? 2e-5 : 2e-3;
    s.solver_parameters = with_iterations(GetParam(), 4);
    s.pose = at(0, 0, 0.05);
    s.obstacles = {obstacle(Plane()), obstacle(Sphere(0.05))};
    s.effects = {{"gravity", {}},
                 {"damping", {}},
                 {"air", {{"volume", "0.004"}, {"seal_breaks", "false"}}},
                 {"contact", {}},
                 {"friction", {}}};
    auto world = make_world(s);
    Random random(6);
    particles_of(*world).v = random.positions(particles_of(*world).size(), 0.3);
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
    Eigen::MatrixXd state(6, particles_of(*world).size());
    state << particles_of(*world).x, particles_of(*world).v;
    return state;
  }
};
PLIANT_FOR_EVERY_SOLVER(Threads);

TEST_P(Threads, GiveIdenticalBits) {
  // 4,900 vertices and 19,000 springs: every parallel loop is really cut, at any grain.
  // Newton's steps take some seconds each, and none keeps anything for the next.
  const int steps = GetParam() == "newton" ? 1 : 3;
  const Eigen::MatrixXd one = result(1, 70, steps);
  for (const int count : {2, 3, 4}) EXPECT_EQ(result(count, 70, steps), one) << count << " threads";
}

TEST_P(Threads, GiveIdenticalBitsOnSmallCloths) {
  const Eigen::MatrixXd one = result(1, 12, 100);
  for (const int count : {2, 4}) EXPECT_EQ(result(count, 12, 100), one) << count << " threads";
}

class MovedScene : public EverySolver {
 protected:
  /// Positions after 0.2 s of a scene that stands at `place`, seen from there.
  Positions result(const Eigen::Isometry3d& place) const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.time_step = 1e-3;
    s.fixed = {0};
    s.obstacles = {obstacle(Plane(), place), obstacle(Sphere(0.05), place * at(0.02, 0.01, 0.05)),
                   obstacle(Box({0.1, 0.04, 0.02}), place * at(-0.1, 0, 0.05))};
    s.pose = place * at(0, 0, 0.12);
    const Eigen::Vector3d g = place.linear() * Eigen::Vector3d(0, 0, -9.81);
    s.effects = {{"gravity", {{"acceleration", fmt::format("{} {} {}", g.x(), g.y(), g.z())}}},
                 {"damping", {}},
                 {"contact", {}},
                 {"friction", {}}};
    auto world = make_world(s);
    run_for(*world, 0.2);
    return place.inverse() * particles_of(*world).x;
  }
  // 200 steps multiply a rounding of 1e-15 m; contacts that open a step later or earlier add to it.
  static constexpr double kTolerance = 1e-8;
};
PLIANT_FOR_EVERY_SOLVER(MovedScene);

TEST_P(MovedScene, TurnedAboutTheVertical) {
  const Positions here = result(at(0, 0, 0));
  for (const double angle : {0.3, 1.5707963267948966, 3.0}) {
    Eigen::Isometry3d place = at(2, -1, 0.5);
    place.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    EXPECT_LE((result(place) - here).cwiseAbs().maxCoeff(), kTolerance) << angle;
  }
}

TEST_P(MovedScene, TurnedAnyWayWithItsGravity) {
  const Positions here = result(at(0, 0, 0));
  Random random(8);
  for (int trial = 0; trial < 3; ++trial) {
    Eigen::Isometry3d place(Eigen::Translation3d(random.vector(2.0)));
    place.linear() = random.rotation();
    EXPECT_LE((result(place) - here).cwiseAbs().maxCoeff(), kTolerance);
  }
}

}  // namespace
}  // namespace pliant::invariance_test
