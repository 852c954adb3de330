// Contact of reduced bodies with obstacles: forces, energy, friction.
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/drivers.h"
#include "support/worlds/reduced_worlds.h"

namespace pliant::reduced_contact_test {
namespace {

constexpr double kOffset = 0.001;  // half the contact effect's thickness [m]

/// A ball under the beam's free end, and gravity.
ReducedScene resting(const std::string& solver) {
  ReducedScene s;
  s.solver = solver;
  s.time_step = 0.002;
  s.material = {{"alpha", "20"}};
  s.obstacles = {obstacle(Sphere(0.1), at(0.4, 0.0, -0.16))};
  s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {}}};
  return s;
}

std::vector<std::string> stable_solvers() {
  return {"trigonometric", "newmark", "midpoint", "reference"};
}

TEST(ReducedContact, AtRestNothingMoves) {
  for (const std::string& solver : stable_solvers()) {
    auto world = make_world(resting(solver));
    run_for(*world, 6.0);
    const Positions x = particles_of(*world).x;
    const double energy = world->energies().elastic;
    const Eigen::Vector3d force = world->reactions()[0].force;
    run_for(*world, 1.0);
    EXPECT_GT(body_of(*world).report.contacts, 0) << solver;
    EXPECT_LE((particles_of(*world).x - x).cwiseAbs().maxCoeff(), 1e-7) << solver;
    EXPECT_LE(world->energies().kinetic, 1e-10 * energy) << solver;
    EXPECT_LE((world->reactions()[0].force - force).norm(), 1e-3 * force.norm()) << solver;
  }
}

TEST(ReducedContact, AtRestForcesAreInBalance) {
  for (const std::string& solver : stable_solvers()) {
    auto world = make_world(resting(solver));
    run_for(*world, 8.0);
    // R(q) = Uᵀ (m g + contact forces).
    ReducedBodySystem& system = reduced_of(*world);
    Forces forces = system.external_forces;
    effect_of<ContactEffect>(*world, "contact").add_forces(forces);
    QuarticPotential::Workspace space;
    Eigen::VectorXd r;
    system.potential.evaluate(system.q, r, space);
    EXPECT_GT(r.norm(), 1.0) << solver;
    EXPECT_LE((soft_beam()->reduced_force(forces) - r).norm(), 1e-4 * r.norm()) << solver;
  }
}

TEST(ReducedContact, ReactionIsTheEnergysSlope) {
  // A plate presses the beam's end down by d: dW/dd = F.
  const auto pressed = [](double depth, double& force) {
    ReducedScene s;
    s.material = {{"alpha", "10"}};
    s.time_step = 0.002;
    s.obstacles = {obstacle(Box(Eigen::Vector3d(0.2, 0.2, 0.1)), at(0.5, 0, 0.1 + kOffset))};
    s.effects = {{"contact", {}}};
    auto world = make_world(s);
    world->add_driver(std::make_unique<StraightDriver>(0, s.obstacles[0].pose_end,
                                                       Eigen::Vector3d(0, 0, -depth), 1.0));
    run_for(*world, 5.0);
    force = world->reactions()[0].force.z();
    double lowest = 1.0;
    for (const Eigen::Vector3d x : particles_of(*world).x.colwise()) {
      if (x.x() > 0.4) lowest = std::min(lowest, 0.05 - depth - x.z());
    }
    EXPECT_GE(lowest, -1e-3 * kOffset);
    return world->energies().elastic;
  };
  double force = 0.0, unused = 0.0;
  const double low = pressed(0.098, unused), high = pressed(0.102, unused);
  pressed(0.1, force);
  EXPECT_GT(force, 1.0);
  EXPECT_NEAR((high - low) / 0.004, force, 0.01 * force);
}

TEST(ReducedContact, AnObstacleAtRestTakesEnergyOrNothing) {
  for (const std::string& solver : stable_solvers()) {
    ReducedScene s;
    s.solver = solver;
    s.velocity = {0.0, 0.4, -1.0};
    s.obstacles = {obstacle(Sphere(0.1), at(0.4, 0.02, -0.17)),
                   obstacle(Sphere(0.1), at(0.35, 0.0, 0.19))};
    s.effects = {{"contact", {}}, {"friction", {}}};
    auto world = make_world(s);
    const double first = world->energies().total();
    double highest = 0.0;
    int touched = 0;
    while (world->time() < 3.0) {
      ASSERT_TRUE(world->step());
      highest = std::max(highest, world->energies().total());
      touched += body_of(*world).report.contacts > 0;
    }
    EXPECT_GT(touched, 10) << solver;
    // What the integrators' own energy swings by without obstacles.
    EXPECT_LE(highest, 1.05 * first) << solver;
    EXPECT_LT(world->energies().total(), 0.9 * first) << solver;
  }
}

TEST(ReducedContact, AHitDoesNotBounce) {
  // The end's speed into the ball is gone when it touches, whatever share of the step was left.
  for (const double gap : {0.0101, 0.0104, 0.0107, 0.0110}) {
    ReducedScene s;
    s.velocity = {0, 0, -1};
    s.obstacles = {obstacle(Sphere(0.1), at(0.5, 0, -0.15 - kOffset - gap))};
    s.effects = {{"contact", {}}};
    auto world = make_world(s);
    while (body_of(*world).report.contacts == 0 && world->time() < 1.0) ASSERT_TRUE(world->step());
    const auto& effect = effect_of<ContactEffect>(*world, "contact");
    const Particles& particles = particles_of(*world);
    for (const Contact& contact : effect.contacts()) {
      if (contact.normal_force == 0.0) continue;
      const double speed = contact.normal.dot(effect.points().position(particles.v, contact.point));
      EXPECT_NEAR(speed, 0.0, 2e-3) << gap;
    }
  }
}

TEST(ReducedContact, SlidingFrictionIsTheCone) {
  // A plate on the beam's end moves sideways; it drags the end along until friction slips.
  ReducedScene s;
  s.material = {{"alpha", "20"}};
  s.obstacles = {obstacle(Box(Eigen::Vector3d(0.2, 2.0, 0.1)), at(0.5, 0, 0.1))};
  s.effects = {{"contact", {}}, {"friction", {{"coefficient", "0.2"}}}};
  for (const double coefficient : {0.2, 100.0}) {
    s.effects[1].second["coefficient"] = std::to_string(coefficient);
    auto world = make_world(s);
    world->add_driver(std::make_unique<StraightDriver>(0, s.obstacles[0].pose_end,
                                                       Eigen::Vector3d(0, 0.02, -0.02), 2.0));
    run_for(*world, 1.9);
    const Eigen::Vector3d force = -world->reactions()[0].force;
    const double along = force.y(), normal = -force.z();
    ASSERT_GT(normal, 1.0);
    if (coefficient < 1.0) {
      EXPECT_NEAR(along, coefficient * normal, 0.02 * normal);
    } else {
      // It sticks: the end goes with the plate.
      EXPECT_LT(along, coefficient * normal);
      const Particles& particles = particles_of(*world);
      for (const Contact& contact : effect_of<ContactEffect>(*world, "contact").contacts()) {
        if (contact.normal_force < 0.1 * normal) continue;
        const Eigen::Vector3d v = effect_of<ContactEffect>(*world, "contact")
                                      .points()
                                      .position(particles.v, contact.point);
        EXPECT_NEAR(v.y(), 0.02, 2e-3);
      }
    }
  }
}

TEST(ReducedContact, ForcesStayBoundedWhereNothingFits) {
  // Plates from above and below, closer than the body is thick: no coordinates fit between them.
  ReducedScene s;
  s.solver = "trigonometric";
  s.obstacles = {obstacle(Box(Eigen::Vector3d(2, 2, 0.1)), at(0, 0, 0.11)),
                 obstacle(Box(Eigen::Vector3d(2, 2, 0.1)), at(0, 0, -0.11))};
  s.effects = {{"contact", {}}, {"friction", {}}};
  auto world = make_world(s);
  world->add_driver(std::make_unique<StraightDriver>(0, s.obstacles[0].pose_end,
                                                     Eigen::Vector3d(0, 0, -0.02), 1.0));
  run_for(*world, 2.0);
  EXPECT_TRUE(particles_of(*world).x.allFinite());
  EXPECT_LE(particles_of(*world).x.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_LE(particles_of(*world).v.cwiseAbs().maxCoeff(), 1.0);
}

}  // namespace
}  // namespace pliant::reduced_contact_test
