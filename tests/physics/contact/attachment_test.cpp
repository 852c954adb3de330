// What attachments carry, whom they push, and how they move what they hold.
#include "pliant/effects/attachment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/drivers.h"
#include "support/worlds/reduced_worlds.h"

namespace pliant::attachment_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s²]

AttachmentRequest hold(World& world, std::vector<int> vertices, double stiffness, int obstacle) {
  AttachmentRequest request;
  request.name = "hook";
  request.region.vertices = std::move(vertices);
  request.count = particles_of(world).size();
  request.stiffness = stiffness;
  request.obstacle = obstacle;
  return request;
}

void attach(World& world, std::vector<int> vertices, double stiffness, int obstacle = -1) {
  attachments_of(body_of(world), world.obstacles())
      .attach_now(hold(world, std::move(vertices), stiffness, obstacle), world.time_step());
}

class HeldCloth : public EverySolver {
 protected:
  static constexpr double kDrag = 5.0;  // [1/s]

  /// A sheet in the vertical plane, its top row held to a ball out of its reach.
  std::unique_ptr<World> make(double stiffness) const {
    ClothScene s;
    s.grid = {0.2, 0.2, 4, 4};
    s.pose.rotate(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX()));
    s.material = soft_material();
    s.obstacles = {obstacle(Sphere(0.05), at(0.0, 0.5, 0.0))};
    s.effects = {{"gravity", {}}, {"damping", {{"rate", std::to_string(kDrag)}}}};
    s.solver = solver();
    s.solver_parameters = converged(s.solver);
    s.time_step = 0.002;
    auto world = make_world(s);
    attach(*world, row_of(s.grid, 3), stiffness, 0);
    return world;
  }
};

TEST_P(HeldCloth, WeighsOnWhatHoldsIt) {
  auto world = make(200.0);
  run_for(*world, 4.0);
  const double weight = kGravity * particles_of(*world).mass.sum();
  const Eigen::Vector3d force = world->reactions()[0].force;
  // Its mass centre's momentum changes by force - weight - drag; swings decay as exp(-kDrag t / 2).
  const double swing = weight * std::exp(-0.5 * kDrag * 4.0);
  EXPECT_NEAR(force.z(), -weight, swing);
  EXPECT_LE(force.head<2>().norm(), swing);
}

TEST_P(HeldCloth, FollowsAMovingObstacle) {
  auto still = make(200.0), moved = make(200.0);
  const Eigen::Vector3d velocity(0.2, 0.1, 0.0);  // [m/s]
  moved->add_driver(std::make_unique<StraightDriver>(0, at(0.0, 0.5, 0.0), velocity, 1.0));
  run_for(*still, 5.0);
  run_for(*moved, 5.0);
  const Eigen::Matrix3Xd shift = particles_of(*moved).x - particles_of(*still).x;
  // 4 s after the stop, of a swing that began with the velocity of the motion over the slowest rate
  const double swing = velocity.norm() / kDrag * 2.0 * std::exp(-0.5 * kDrag * 4.0);
  for (int i = 0; i < shift.cols(); ++i) {
    EXPECT_LE((shift.col(i) - velocity * 1.0).norm(), swing) << i;
  }
}

PLIANT_FOR_EVERY_SOLVER(HeldCloth);

class HeldReduced : public testing::TestWithParam<std::string> {};

/// Vertices of the beam's free end.
std::vector<int> tip(const ReducedModel& model) {
  std::vector<int> found;
  for (int i = 0; i < model.mesh.vertices.cols(); ++i) {
    if (model.mesh.vertices(0, i) > 0.499) found.push_back(i);
  }
  return found;
}

double mean_height(const World& world, const std::vector<int>& vertices) {
  const Particles& particles = world.bodies().front().particles();
  double moment = 0.0, mass = 0.0;
  for (int i : vertices) {
    moment += particles.mass[i] * particles.x(2, i);
    mass += particles.mass[i];
  }
  return moment / mass;
}

double lowest_rate() { return std::sqrt(soft_beam()->potential.lambda()[0]); }  // [rad/s]

/// Damped critically; after settling_time() 1e-5 of a motion is left.
double settling_time() { return 14.0 / lowest_rate(); }  // [s]

ReducedScene slow_beam(const std::string& solver, const std::string& gravity) {
  ReducedScene s;
  s.solver = solver;
  s.time_step = solver == "reference" ? 0.002 : 0.001;  // its own steps are parts of that
  s.material = {{"alpha", std::to_string(2.0 * lowest_rate())}};
  s.effects = {{"gravity", {{"acceleration", "[0, 0, " + gravity + "]"}}}};
  s.obstacles = {obstacle(Sphere(0.05), at(0.0, 1.0, 0.0))};
  return s;
}

/// Small deflections add up: with w the sag of the tip's middle under its own weight and c its
/// displacement per force, a spring k that ties it carries F = w / (c + 1/k).
TEST_P(HeldReduced, CarriesTheShareOfTheWeightThatBeamsGiveIt) {
  const double load = 0.005;  // [N]; the beam weighs 0.01 N here, and sags by 0.4 mm
  auto hanging = make_world(slow_beam(GetParam(), "-0.001"));
  auto pushed = make_world(slow_beam(GetParam(), "0"));
  const Positions start = particles_of(*hanging).x;
  const auto at_tip = [&](int i) {
    return (start.col(i) - Eigen::Vector3d(0.5, 0, 0)).norm() < 0.01;
  };
  int tip = 0;
  while (!at_tip(tip)) ++tip;
  AppliedForce force;
  force.point = start.col(tip);
  force.force = {0.0, 0.0, -load};
  force.duration = -1.0;
  pushed->applied_forces().add(force);
  run_for(*hanging, settling_time());
  run_for(*pushed, settling_time());
  const Eigen::Vector3d sag = start.col(tip) - particles_of(*hanging).x.col(tip);
  const Eigen::Vector3d displacement = start.col(tip) - particles_of(*pushed).x.col(tip);
  // A cube's five tetrahedra are not symmetric: what of its motion is not along z.
  ASSERT_LE(displacement.head<2>().norm(), 0.02 * displacement.z());
  for (const double stiffness : {1.0, 1e3, 1e8}) {
    auto held = make_world(slow_beam(GetParam(), "-0.001"));
    attach(*held, {tip}, stiffness, 0);
    run_for(*held, settling_time());
    const double expected = sag.z() / (displacement.z() / load + 1.0 / stiffness);
    // Stiffening is of second order in the deflection over the thickness, 0.005, and what is not
    // along z in 0.02.
    EXPECT_NEAR(-held->reactions()[0].force.z(), expected, 1e-3 * expected) << stiffness;
  }
}

TEST_P(HeldReduced, FollowsAMovingObstacle) {
  const std::vector<int> end = tip(*soft_beam());
  ReducedScene s = slow_beam(GetParam(), "0");
  auto world = make_world(s);
  attach(*world, end, 1e7, 0);
  const double start = mean_height(*world, end);
  world->add_driver(
      std::make_unique<StraightDriver>(0, at(0.0, 1.0, 0.0), Eigen::Vector3d(0.0, 0.0, 0.05), 1.0));
  run_for(*world, 1.5);
  // What bends and stretches it is some tens of newton.
  EXPECT_NEAR(mean_height(*world, end) - start, 0.05, 1e-5);
}

/// u = (x, 0, 0) q with spring k in all at x = ±0.2 m: K = 0.04 k. Force and damper of a step are
///   f = -K (q + q')/2,  p' = (p + ...) / (1 + h² K / 2),
/// so that the frequency is √(λ + K) to second order and the amplitude falls by ¼ h K a second.
TEST_P(HeldReduced, SwingsWithTheSpringsFrequency) {
  const double lambda = 400.0, k = 4e4, stiffness = 0.04 * k;
  ReducedScene s;
  s.model = stretching_block(lambda);
  s.solver = GetParam();
  s.time_step = 5e-4;
  auto world = make_world(s);
  const Eigen::Matrix3Xd& rest = s.model->mesh.vertices;
  std::vector<int> ends;
  for (int i = 0; i < rest.cols(); ++i) {
    if (std::abs(rest(0, i)) > 0.199) ends.push_back(i);
  }
  attach(*world, ends, k);
  ReducedBodySystem& system = reduced_of(*world);
  system.q[0] = 0.01;
  system.move_particles();
  const double omega = std::sqrt(lambda + stiffness);
  double last = system.q[0];
  int crossings = 0;
  double first_time = 0.0, last_time = 0.0, peak = 0.0;
  while (crossings < 21) {
    ASSERT_TRUE(world->step());
    const double q = system.q[0];
    if ((q > 0.0) != (last > 0.0)) {
      last_time = world->time() - s.time_step * q / (q - last);
      if (crossings == 0) first_time = last_time;
      ++crossings;
      peak = 0.0;
    }
    peak = std::max(peak, std::abs(q));
    last = q;
  }
  const double measured = 20.0 * M_PI / (last_time - first_time);
  const double hw = s.time_step * omega;
  EXPECT_NEAR(measured, omega, 0.5 * hw * hw * omega);
  if (GetParam() == "imex_thesis") return;  // of first order: has a gain of its own
  const double amplitude = std::hypot(system.q[0], system.p[0] / omega);
  const double expected = 0.01 * std::exp(-0.25 * s.time_step * stiffness * world->time());
  EXPECT_NEAR(amplitude / expected, 1.0, 2.0 * hw);
}

TEST_P(HeldReduced, NeverGainsEnergyHoweverFirm) {
  for (const double stiffness : {1.0, 1e4, 1e8, 1e12}) {
    ReducedScene s = slow_beam(GetParam(), "0");
    s.material = {};
    s.velocity = {0.0, 0.0, 0.05};
    auto world = make_world(s);
    attach(*world, tip(*s.model), stiffness);
    const double start = world->energies().total();
    for (int k = 0; k < 1000; ++k) {
      ASSERT_TRUE(world->step());
      // Time integrators keep a shadow of the energy: within (h ω)² / 4 of the coordinates that
      // move.
      ASSERT_LE(world->energies().total(), 1.05 * start) << stiffness << " N/m, step " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, HeldReduced, testing::ValuesIn(reduced_solvers()),
                         test_name_of);

}  // namespace
}  // namespace pliant::attachment_test
