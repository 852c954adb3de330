// Coulomb friction on a tilted plane: a cloth slides above the angle of friction and stays below.
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant::incline_test {
namespace {

constexpr double kMu = 0.5, kGravity = 9.81;

class Incline : public EverySolver {
 protected:
  /// A soft cloth at its contact distance on a plane that falls by `angle` along +x.
  std::unique_ptr<World> cloth_on(double angle) const {
    Eigen::Isometry3d tilt = Eigen::Isometry3d::Identity();
    tilt.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.solver_parameters = converged(GetParam());
    s.time_step = 1e-3;
    s.obstacles = {obstacle(Plane(), tilt)};
    s.pose = tilt * at(0, 0, 0.001);
    s.effects = {
        {"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", std::to_string(kMu)}}}};
    return make_world(s);
  }
};
PLIANT_FOR_EVERY_SOLVER(Incline);

TEST_P(Incline, SlidesAboveTheAngleOfFriction) {
  for (const double degrees : {30.0, 45.0, 60.0}) {
    const double angle = degrees * M_PI / 180.0;
    auto world = cloth_on(angle);
    run_for(*world, 0.2);
    const Eigen::Vector3d down(std::cos(angle), 0, -std::sin(angle));
    const Eigen::RowVectorXd speed = down.transpose() * particles_of(*world).v;
    const double a = kGravity * (std::sin(angle) - kMu * std::cos(angle));
    // Constant acceleration is exact for n h; iterations leave 1e-8 of it.
    EXPECT_NEAR(speed.minCoeff(), 0.2 * a, 1e-6) << degrees;
    EXPECT_NEAR(speed.maxCoeff(), 0.2 * a, 1e-6) << degrees;
  }
}

TEST_P(Incline, StaysBelowTheAngleOfFriction) {
  for (const double degrees : {0.0, 10.0, 26.0}) {
    auto world = cloth_on(degrees * M_PI / 180.0);
    const Positions start = particles_of(*world).x;
    run_for(*world, 0.5);
    // No creep: sticking is a constraint, not a steep force.
    EXPECT_LE((particles_of(*world).x - start).cwiseAbs().maxCoeff(), 1e-9) << degrees;
    const double weight = kGravity * particles_of(*world).mass.sum();
    EXPECT_LE((world->reactions()[0].force - Eigen::Vector3d(0, 0, -weight)).norm(), 1e-6 * weight);
  }
}

TEST_P(Incline, PushedUphillItStopsAndStays) {
  const double angle = 20.0 * M_PI / 180.0;
  auto world = cloth_on(angle);
  const Eigen::Vector3d up(-std::cos(angle), 0, std::sin(angle));
  particles_of(*world).v.colwise() = 0.5 * up;
  const Positions start = particles_of(*world).x;
  run_for(*world, 0.3);
  // Distance to rest of the discrete scheme: v²/2a less up to half a step's, 0.5 * 0.5 * 1e-3 m.
  const double a = kGravity * (std::sin(angle) + kMu * std::cos(angle));
  const Eigen::RowVectorXd travel = up.transpose() * (particles_of(*world).x - start);
  EXPECT_NEAR(travel.mean(), 0.25 / (2.0 * a), 0.25e-3);
  EXPECT_LE(particles_of(*world).v.cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace pliant::incline_test
