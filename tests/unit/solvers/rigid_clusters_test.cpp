#include "pliant/solvers/components/rigid_clusters.h"

#include <gtest/gtest.h>

#include "support/worlds/body_pairs.h"

namespace pliant::rigid_clusters_test {
namespace {

bool is_rigid_alone(const std::string& body) {
  const auto world = world_of(scene_text({"  - {name: body, " + body + "}\n"}, "  gravity: {}\n"));
  EXPECT_TRUE(world->step()) << world->failure();  // attachments begin
  return is_made_of_rigid_bodies(*world->bodies().front().model->system().as_projective());
}

TEST(RigidClusters, AreAllOfARigidBodyThatNothingHolds) {
  const std::string box = "model: rigid, geometry: {box: {size: [0.1, 0.1, 0.1]}}";
  EXPECT_TRUE(is_rigid_alone(box));
  EXPECT_FALSE(is_rigid_alone(box +
                              ", attachments: [{name: grip, sphere: {center: [0, 0, 0], radius: "
                              "1}, to: world, stiffness: 100}]"))
      << "a spring holds it";
}

TEST(RigidClusters, AreNotAllOfOtherBodies) {
  EXPECT_FALSE(
      is_rigid_alone("model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [3, 3]}}"));
  const std::string block =
      "model: viscoelastic, geometry: {block: {size: [0.03, 0.03, 0.03]}, spacing: 0.01}, ";
  EXPECT_FALSE(is_rigid_alone(block + "material: {state: elastic}"));
  EXPECT_FALSE(is_rigid_alone(block + "material: {state: liquid}")) << "nothing is no rigid body";
}

}  // namespace
}  // namespace pliant::rigid_clusters_test
