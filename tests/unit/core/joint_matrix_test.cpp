// What element sets of several bodies add to the matrix of the joint system: as few entries as in
// their own.
#include <gtest/gtest.h>

#include "pliant/core/system/joint_system.h"
#include "pliant/solvers/linear/block_matrix.h"
#include "support/random.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::joint_matrix_test {
namespace {

void assemble(const ProjectiveSystem& system, BlockMatrix& matrix) {
  do {
    matrix.begin(system.particles, Eigen::VectorXd::Ones(system.particles.size()));
    for (const auto& set : system.elements) {
      set->add_stiffness(system.particles.x, Definiteness::kProjected, matrix);
    }
  } while (!matrix.finish());
}

TEST(JointMatrix, KeepsScalarsAndWhatParticlesShare) {
  const auto world =
      world_of(scene_text({slab("cloth", "cloth", 1.0), slab("jelly", "viscoelastic", 2.0)},
                          "  gravity: {}\n", "solver: {name: newton}\n"));
  ASSERT_TRUE(world->step());
  System& cloth = world->bodies()[0].model->system();
  System& jelly = world->bodies()[1].model->system();
  JointSystem joint({&cloth, &jelly});
  joint.take();
  BlockMatrix both, of_cloth, of_jelly;
  assemble(joint, both);
  assemble(*cloth.as_projective(), of_cloth);
  assemble(*jelly.as_projective(), of_jelly);
  ASSERT_GT(of_cloth.scalars(), 0);
  ASSERT_GT(of_jelly.shared().count(), 0);
  EXPECT_EQ(both.scalars(), of_cloth.scalars() + of_jelly.scalars());
  EXPECT_EQ(both.entries(), of_cloth.entries() + of_jelly.entries());
  EXPECT_EQ(both.shared().members(), of_jelly.shared().members());
  const int n = cloth.particles.size(), m = jelly.particles.size();
  const Eigen::Matrix3Xd v = Random(3).positions(n + m, 1.0);
  Eigen::Matrix3Xd y, own;
  both.multiply(v, y);
  of_cloth.multiply(v.leftCols(n), own);
  EXPECT_LT((y.leftCols(n) - own).norm(), 1e-14 * own.norm());
  of_jelly.multiply(v.rightCols(m), own);
  EXPECT_LT((y.rightCols(m) - own).norm(), 1e-14 * own.norm());
}

}  // namespace
}  // namespace pliant::joint_matrix_test
