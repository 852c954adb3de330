#include "support/solvers/stable_step.h"
#include "support/worlds/drivers.h"

namespace pliant {
namespace {

// Two boxes close on a cloth to no gap at all, less than the thickness that contact keeps: what is
// asked for cannot be had, so the particles are left where one of the boxes puts them.
class Pinch : public EverySolver {
 protected:
  static constexpr double kSpeed = 0.05;  // of each box [m/s]
  static constexpr double kGap = 0.01;    // half the first one [m]

  std::unique_ptr<World> closing(double width) const {
    const Box box({width, width, 0.02});
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {obstacle(box, at(0, 0, -kGap - 0.01)), obstacle(box, at(0, 0, kGap + 0.01))};
    scene.effects = {{"damping", {}}, {"contact", {{"thickness", "0.002"}}}, {"friction", {}}};
    scene.solver = solver();
    scene.pose = at(0, 0, 0.003);  // the upper box comes first
    auto world = make_stable_world(scene);
    for (std::size_t o : {std::size_t{0}, std::size_t{1}}) {
      const Eigen::Vector3d velocity(0, 0, o == 0 ? kSpeed : -kSpeed);
      world->add_driver(std::make_unique<StraightDriver>(o, scene.obstacles[o].pose_start, velocity,
                                                         kGap / kSpeed));
    }
    return world;
  }
};

// Contact moves a particle out of a solid at 1 m/s at most beyond the surface's own motion, a
// thread doubles that at most. The forces of both boxes together accelerate the cloth: within its
// mass times twice that speed a step; one alone pushes by the pinched thickness in each iteration.
TEST_P(Pinch, EjectsNothingAndPressesWithBoundedForce) {
  for (double width : {0.4, 0.12}) {
    const auto world = closing(width);
    const Particles& particles = particles_of(*world);
    const double fastest = 2.0 * (1.0 + kSpeed);
    const double h = world->time_step();
    const double unit = particles.mass.sum() / h;
    const double depth = 0.002 + 1.0 * h;
    double largest = 0.0;
    int pinched = 0;
    bool is_told = false;
    while (world->time() < 2.0 * kGap / kSpeed) {
      ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
      largest = std::max(largest, largest_speed(*world));
      ASSERT_LT(largest_speed(*world), fastest) << width << " m at " << world->time();
      for (const std::string& warning : body_of(*world).report.warnings) {
        is_told = is_told || warning.rfind("pinched: '", 0) == 0;
      }
      const Eigen::Vector3d a = world->reactions()[0].force, b = world->reactions()[1].force;
      if (a.z() != 0.0 && b.z() != 0.0) ++pinched;
      const int iterations = std::max(2, body_of(*world).report.iterations) + 1;
      ASSERT_LT((a + b).norm(), 2.0 * fastest * unit);
      ASSERT_LT(std::max(a.norm(), b.norm()), iterations * depth / h * unit * 2.0);
    }
    RecordProperty("speed_" + std::to_string(width), std::to_string(largest));
    EXPECT_TRUE(is_told) << width;
    EXPECT_GT(pinched, 0) << "only one box touched the cloth";
    // Between the boxes: no further out than the thickness that it would need.
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.x.col(i).head<2>().cwiseAbs().maxCoeff() > 0.5 * width - 0.002) continue;
      EXPECT_LT(std::abs(particles.x(2, i)), 0.001 + 1e-6);
    }
  }
}

PLIANT_FOR_EVERY_SOLVER(Pinch);

}  // namespace
}  // namespace pliant
