#include "support/disturb.h"
#include "support/solvers/stable_step.h"

namespace pliant {
namespace {

// A cloth 1 km from the origin does what it does at the origin. A position is rounded to 1.1e-13 m
// there; a step that rounds by one such unit changes the velocity by it over h, hence the position
// n steps later by n units: n² units in all.
class FarAway : public EverySolver {
 protected:
  static constexpr int kSteps = 100;
  static constexpr double kBound = kSteps * kSteps * 1.2e-13;  // [m]

  Positions run(ClothScene scene, const Eigen::Vector3d& origin) const {
    const Eigen::Isometry3d shift(Eigen::Translation3d{origin});
    scene.pose = shift * scene.pose;
    for (Obstacle& obstacle : scene.obstacles) {
      obstacle.pose_start = obstacle.pose_end = shift * obstacle.pose_end;
    }
    const auto world = make_world(scene);
    disturb(*world, 0.0, 0.2);
    for (int k = 0; k < kSteps; ++k) EXPECT_TRUE(world->step());
    return particles_of(*world).x.colwise() - origin;
  }

  ClothScene hanging() const {
    ClothScene scene;
    scene.material = soft_material();
    scene.solver = solver();
    // Short of convergence, round-off may decide how many inner iterations a solver takes.
    scene.solver_parameters = with_iterations(solver(), 50);
    scene.effects = {{"gravity", {}}, {"contact", {}}};
    scene.fixed = row_of(scene.grid, 6);
    scene.pose.linear() = Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    scene.time_step = 0.5 * stable_step(scene);
    return scene;
  }
};

TEST_P(FarAway, HangsAsAtTheOrigin) {
  const ClothScene scene = hanging();
  const Positions near = run(scene, Eigen::Vector3d::Zero());
  for (const Eigen::Vector3d& origin :
       {Eigen::Vector3d(1000, 0, 0), Eigen::Vector3d(-600, 800, 700)}) {
    EXPECT_LT((run(scene, origin) - near).colwise().norm().maxCoeff(), kBound);
  }
}

// A ball pressed into the hanging cloth.
TEST_P(FarAway, TouchesAsAtTheOrigin) {
  ClothScene scene = hanging();
  scene.obstacles = {obstacle(Sphere(0.05), at(0, 0.04, 0))};
  const Positions near = run(scene, Eigen::Vector3d::Zero());
  const Positions far = run(scene, Eigen::Vector3d(-600, 800, 700));
  EXPECT_LT((far - near).colwise().norm().maxCoeff(), kBound);
}

PLIANT_FOR_EVERY_SOLVER(FarAway);

}  // namespace
}  // namespace pliant
