#include "support/meshes/shapes.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class ObstacleStart : public EverySolver {
 protected:
  static constexpr double kOffset = 0.001;  // half the thickness [m]

  ClothScene scene(const Obstacle& solid) const {
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {solid};
    scene.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {{"thickness", "0.002"}}}};
    scene.solver = solver();
    return scene;
  }

  static double smallest_distance(const World& world) {
    const Obstacle& solid = world.obstacles().front();
    const Positions& x = world.bodies().front().particles().x;
    double smallest = 1.0;
    for (int i = 0; i < x.cols(); ++i) {
      smallest = std::min(smallest, solid.shape->distance(solid.pose_end.inverse() * x.col(i)));
    }
    return smallest;
  }

  /// Runs and returns the largest speed.
  static double run(World& world, double seconds) {
    double speed = 0.0;
    const double end = world.time() + seconds;
    while (world.time() < end) {
      if (!world.step()) {
        ADD_FAILURE() << body_of(world).report.failure;
        break;
      }
      speed = std::max(speed, largest_speed(world));
    }
    return speed;
  }
};

// Laid where contact wants it, nothing moves it.
TEST_P(ObstacleStart, AtItsDistanceItStays) {
  ClothScene scene = this->scene(obstacle(Plane()));
  scene.pose = at(0, 0, kOffset);
  scene.effects.push_back({"friction", {}});
  const auto world = make_stable_world(scene);
  const Positions start = particles_of(*world).x;
  run(*world, 0.3);
  EXPECT_LE((particles_of(*world).x - start).cwiseAbs().maxCoeff(), 1e-9);
}

// A cloth laid exactly on a surface is too deep by half its thickness. It is parted at the speed
// that opens this in 20 ms, 5 cm/s, rises by v² / 2g = 0.13 mm at most and comes to lie.
TEST_P(ObstacleStart, ExactlyOnASurfaceIsLiftedGently) {
  const double speed = kOffset / 0.02;
  for (const Obstacle& solid :
       {obstacle(Plane()), obstacle(Box({0.4, 0.4, 0.1}), at(0, 0, -0.05))}) {
    const auto world = make_stable_world(scene(solid));
    const double step = 9.81 * world->time_step();
    EXPECT_LT(run(*world, 0.1), speed + step) << solid.name;
    const double highest = particles_of(*world).x.row(2).maxCoeff();
    EXPECT_LT(highest, kOffset + speed * speed / (2.0 * 9.81)) << solid.name;
    EXPECT_LT(run(*world, 1.0), speed + step) << solid.name;
    EXPECT_NEAR(smallest_distance(*world), kOffset, 1e-6) << solid.name;
    EXPECT_NEAR(particles_of(*world).x.row(2).maxCoeff(), kOffset, 1e-4) << solid.name;
  }
}

// The whole cloth is 10 cm deep in a large solid: it rises as one, at 1 m/s at most, until it is
// out.
TEST_P(ObstacleStart, DeepInsideASolidLeavesAtOneMetrePerSecondAtMost) {
  const auto world = make_stable_world(scene(obstacle(Box({1.0, 1.0, 0.2}))));
  EXPECT_LT(run(*world, 0.2), 1.0 + 1e-9);
  EXPECT_GT(smallest_distance(*world), kOffset - 1e-6);
  EXPECT_LT(run(*world, 1.0), 1.0 + 1e-9);
  EXPECT_NEAR(smallest_distance(*world), kOffset, 1e-6);
}

// A cloth that sticks through a solid is drawn out sideways and upwards at once. That stretches its
// threads, by the depth of 10 cm at most, and what they store may become motion: no more than that.
TEST_P(ObstacleStart, ThroughASolidIsPushedOut) {
  for (const char* shape : {"sphere", "box", "capsule", "cylinder"}) {
    Obstacle solid = obstacle(Sphere(0.1));
    solid.name = shape;
    solid.shape = primitive(shape);
    const auto world = make_stable_world(scene(solid));
    const double threads = static_cast<double>(stretch_strains(*world).size());
    const double stored = threads * 0.5 * 10.0 * 0.1 * 0.1;
    EXPECT_LT(largest_energy(*world, 0.2), stored) << solid.name;
    EXPECT_GT(smallest_distance(*world), kOffset - 1e-5) << solid.name;
  }
}

PLIANT_FOR_EVERY_SOLVER(ObstacleStart);

}  // namespace
}  // namespace pliant
