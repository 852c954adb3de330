// Reaction forces of cloth at rest on obstacles, and cloth thrown at a thin one.
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant::resting_contact_test {
namespace {

class RestingCloth : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(RestingCloth);

TEST_P(RestingCloth, PressesWithItsWeight) {
  ClothScene s;
  s.solver = GetParam();
  s.material = soft_material();
  s.time_step = is_explicit(solver()) ? 1e-3 : 4e-3;
  s.obstacles = {obstacle(Plane()), obstacle(Sphere(0.04), at(0.02, 0, 0.04))};
  s.pose = at(0, 0, 0.085);
  s.effects = {{"gravity", {}}, {"damping", {{"rate", "15"}}}, {"contact", {}}, {"friction", {}}};
  auto world = make_world(s);
  run_for(*world, 4.0);
  const double weight = 9.81 * particles_of(*world).mass.sum();
  const double left_over = particles_of(*world).v.cwiseAbs().maxCoeff();
  EXPECT_LE(left_over, 1e-3);
  const Eigen::Vector3d plane = world->reactions()[0].force, sphere = world->reactions()[1].force;
  EXPECT_LT(plane.z(), -0.1 * weight);
  EXPECT_LT(sphere.z(), -0.1 * weight);
  // What still moves is slowed by damping: 15 1/s times 1e-3 m/s is 0.15 % of g.
  EXPECT_LE((plane + sphere - Eigen::Vector3d(0, 0, -weight)).norm(), 3e-3 * weight);
}

struct Throw {
  std::string solver;
  double dt;
};

std::vector<Throw> throws() {
  std::vector<Throw> all;
  for (const std::string& name : cloth_solvers()) {
    // The soft cloth below is stable with verlet up to 3 ms.
    const std::vector<double> rates =
        is_explicit(name) ? std::vector<double>{1000, 4000} : std::vector<double>{60, 240, 1000};
    for (const double rate : rates) all.push_back({name, 1.0 / rate});
  }
  return all;
}

class ThrownCloth : public testing::TestWithParam<Throw> {
 protected:
  std::unique_ptr<World> thrown(const Eigen::Matrix3d& turn,
                                const Eigen::Vector3d& velocity) const {
    ClothScene s;
    s.grid = {0.3, 0.3, 9, 9};
    s.solver = GetParam().solver;
    s.time_step = GetParam().dt;
    s.material = soft_material();
    s.obstacles = {obstacle(Box(Eigen::Vector3d(4, 4, 0.002)))};
    s.pose = at(0, 0, 0.4);
    s.pose.linear() = turn;
    s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {}}};
    auto world = make_world(s);
    particles_of(*world).v.colwise() = velocity;
    return world;
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, ThrownCloth, testing::ValuesIn(throws()), [](const auto& info) {
  return info.param.solver + "_" + std::to_string(std::lround(1.0 / info.param.dt)) + "Hz";
});

TEST_P(ThrownCloth, DoesNotPassAThinBox) {
  const Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d edge_first =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 0.5, 0).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& turn : {flat, edge_first}) {
    for (const Eigen::Vector3d& velocity :
         {Eigen::Vector3d(0, 0, -10), Eigen::Vector3d(6, 0, -8)}) {
      auto world = thrown(turn, velocity);
      const int steps = static_cast<int>(std::ceil(0.2 / GetParam().dt));
      for (int k = 0; k < steps; ++k) {
        ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
        // 1 mm of box and 1 mm of cloth, to the sweep's 1e-9 of the lengths involved.
        ASSERT_GE(particles_of(*world).x.row(2).minCoeff(), 0.002 - 1e-8);
      }
      EXPECT_LE(particles_of(*world).x.row(2).minCoeff(), 0.01) << "it never got there";
    }
  }
}

}  // namespace
}  // namespace pliant::resting_contact_test
