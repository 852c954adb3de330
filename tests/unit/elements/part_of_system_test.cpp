// Sets of tetrahedra for one part of a system.
#include <gtest/gtest.h>

#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "unit/elements/element_examples.h"

namespace pliant {
namespace {

using Make = std::unique_ptr<ElementSet> (*)(const TetrahedralMesh& rest, int first_particle);

std::unique_ptr<ElementSet> make_tetrahedron(const TetrahedralMesh& rest, int first) {
  return std::make_unique<TetrahedronSet>(rest, 500.0, first);
}
std::unique_ptr<ElementSet> make_volume(const TetrahedralMesh& rest, int first) {
  return std::make_unique<VolumeSet>(rest, 1000.0, VolumeLimits{0.9, 1.1}, first);
}
std::unique_ptr<ElementSet> make_strain_limit(const TetrahedralMesh& rest, int first) {
  return std::make_unique<StrainLimitSet>(rest, 1000.0, StretchLimits{0.95, 1.05}, first);
}
std::unique_ptr<ElementSet> make_fiber(const TetrahedralMesh& rest, int first) {
  return std::make_unique<FiberSet>(rest, 1000.0, Eigen::Vector3d(1.0, 2.0, 3.0), first);
}

class APartOfASystem : public testing::TestWithParam<Make> {
 protected:
  static constexpr int kFirst = 7, kBehind = 4;
  TetrahedralMesh rest_ = example_block(2);
  int own_ = static_cast<int>(rest_.vertices.cols());
  int all_ = kFirst + own_ + kBehind;
  std::unique_ptr<ElementSet> alone_ = GetParam()(rest_, 0), part_ = GetParam()(rest_, kFirst);
};

INSTANTIATE_TEST_SUITE_P(Sets, APartOfASystem,
                         testing::Values(make_tetrahedron, make_volume, make_strain_limit,
                                         make_fiber),
                         [](const auto& info) {
                           return std::string(info.param(example_block(1), 0)->name());
                         });

TEST_P(APartOfASystem, ActsOnItsOwnParticlesAsIfTheyWereAlone) {
  Random random(4);
  Positions x = random.positions(all_, 1.0);
  x.middleCols(kFirst, own_) = rest_.vertices + random.positions(own_, 0.03);
  const Positions own = x.middleCols(kFirst, own_);
  EXPECT_EQ(part_->energy(x), alone_->energy(own));
  const Forces f = forces_of(*part_, x);
  EXPECT_GT(f.norm(), 0.0);
  EXPECT_EQ(f.middleCols(kFirst, own_), forces_of(*alone_, own));
  EXPECT_TRUE(f.leftCols(kFirst).isZero(0.0));
  EXPECT_TRUE(f.rightCols(kBehind).isZero(0.0));
  const Eigen::MatrixXd a = system_of(*part_, all_);
  EXPECT_EQ(a.block(kFirst, kFirst, own_, own_), system_of(*alone_, own_));
  EXPECT_EQ(a.norm(), a.block(kFirst, kFirst, own_, own_).norm());
  const Eigen::MatrixXd k = stiffness_of(*part_, x);
  EXPECT_EQ(k.block(3 * kFirst, 3 * kFirst, 3 * own_, 3 * own_), stiffness_of(*alone_, own));
}

TEST_P(APartOfASystem, RefusesANegativeFirstParticle) {
  expect_refusal([&] { GetParam()(rest_, -1); },
                 {std::string(part_->name()), "first particle is -1"});
}

}  // namespace
}  // namespace pliant
