// The liquid of the CUDA backend, its kernels run by the CPU, against Liquid.
#include "cuda/models/viscoelastic/device_liquid.h"

#include <gtest/gtest.h>

#include <set>

#include "cuda/core/host_executor.h"
#include "pliant/core/step/step_report.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/solvers/device/backend.h"
#include "support/worlds/liquid_sample.h"

namespace pliant {
namespace {

struct Collect {
  std::set<int> found;
  int calls = 0;
  void operator()(int j, float, Float3) {
    found.insert(j);
    ++calls;
  }
};

/// Every pair within H, once, with particles so far apart that cubes share numbers.
TEST(ParticleGrid, FindsWhatIsNear) {
  Random random(3);
  const double support = 0.1, quantum = support / (1 << 20);
  Positions x = random.positions(700, 0.3);
  x.leftCols(100).row(0).array() += 0.1 * 16.0;  // where the grid begins anew
  x.middleCols(100, 50).row(1).array() -= 90.0;
  x.col(5) = x.col(6);
  const int n = static_cast<int>(x.cols());
  std::vector<Fixed> places;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3i at = (x.col(i) / quantum).array().round().matrix().cast<int>();
    places.push_back({at[0], at[1], at[2], 1.0f});
  }
  HostExecutor executor;
  ParticleGrid<HostExecutor> grid;
  const double extent[3] = {0.6, 0.6, 0.6};
  grid.shape(n, extent, support, quantum);
  grid.build(executor, places.data());
  GridView view = grid.view();
  std::vector<Fixed> ranked;
  std::set<int> particles;
  for (int k = 0; k < n; ++k) {
    ranked.push_back(places[static_cast<std::size_t>(view.order[k])]);
    particles.insert(view.order[k]);
  }
  EXPECT_EQ(static_cast<int>(particles.size()), n);
  for (int cube = 0; cube < view.cubes(); ++cube) {
    for (int k = view.begins[cube] + 1; k < view.begins[cube + 1]; ++k) {
      EXPECT_LT(view.order[k - 1], view.order[k]);
    }
  }
  view.x = ranked.data();
  std::size_t pairs = 0;
  for (int k = 0; k < n; ++k) {
    Collect near;
    sum_near(view, k, near);
    EXPECT_EQ(near.calls, static_cast<int>(near.found.size()));
    for (int j = 0; j < n; ++j) {
      const double apart = (x.col(view.order[k]) - x.col(view.order[j])).norm();
      if (j == k || std::abs(apart - support) < 1e-5) continue;
      EXPECT_EQ(near.found.count(j) > 0, apart < support);
    }
    pairs += near.found.size();
  }
  EXPECT_GT(pairs, 1000u);
}

class DeviceLiquidForces : public testing::Test {
 protected:
  DeviceLiquidForces() {
    for (Liquid* liquid : {&cpu_, &device_}) sample_.add_to(*liquid);
  }

  Forces forces(Liquid& liquid, LiquidWalls* walls) {
    report_.begin(1, 0.0, 0.001);
    Forces f = Forces::Zero(3, sample_.particles.size());
    liquid.add_forces(sample_.particles, sample_.beta, walls, f, report_);
    return f;
  }

  void expect_same(LiquidWalls* walls) {
    const Forces exact = forces(cpu_, walls);
    const Forces found = forces(device_, walls);
    EXPECT_TRUE(device_.has_device());
    // ψ is a sum of 33 terms: a few ε of it; pressure grows from ψ − 1, a tenth of it here.
    EXPECT_LE((device_.last_filling() - cpu_.last_filling()).cwiseAbs().maxCoeff(), 33 * 6e-8);
    EXPECT_GT(cpu_.last_filling().maxCoeff(), 1.1);
    const double largest = exact.colwise().norm().maxCoeff();
    EXPECT_LE((found - exact).colwise().norm().maxCoeff(), 10 * 33 * 6e-8 * largest);
  }

  LiquidSample sample_;
  Liquid cpu_, device_;
  StepReport report_;
};

TEST_F(DeviceLiquidForces, AreThoseOfTheCpu) {
  device_.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  expect_same(nullptr);
  // Again where particles moved.
  sample_.particles.x += 0.001 * sample_.particles.v;
  expect_same(nullptr);
}

TEST_F(DeviceLiquidForces, AreThoseOfTheCpuAtWalls) {
  device_.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  Obstacle floor;
  floor.shape = std::make_shared<Plane>();
  floor.pose_start = floor.pose_end = Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.005));
  LiquidWalls walls;
  walls.find(sample_.particles.x, {floor}, cpu_.support(), 0.001);
  ASSERT_TRUE(walls.any());
  expect_same(&walls);
}

TEST_F(DeviceLiquidForces, RepeatToTheBitAndAddUpToNothing) {
  device_.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  const Forces f = forces(device_, nullptr);
  EXPECT_EQ(forces(device_, nullptr), f);
  // Pairs are equal and opposite to the bit: what is left are roundings of sums.
  EXPECT_LE(f.rowwise().sum().norm(), 6e-8 * f.colwise().norm().sum());
}

TEST_F(DeviceLiquidForces, ParticlesTooFarApartAreLeftToTheCpu) {
  device_.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  sample_.particles.x(0, 3) += 1e7 * cpu_.support();
  const Forces exact = forces(cpu_, nullptr);
  EXPECT_EQ(forces(device_, nullptr), exact);
  EXPECT_FALSE(device_.has_device());
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_NE(report_.warnings[0].find("too far apart"), std::string::npos);
}

class FailingLiquid final : public LiquidDevice {
 public:
  void add_forces(const LiquidState&, const Eigen::VectorXf&, Eigen::VectorXd&, Forces&) override {
    fail();
  }
  void cohesion(const LiquidState&, Eigen::Matrix3Xd&) override { fail(); }
  void mixing(const LiquidState&, Eigen::Matrix3Xd&) override { fail(); }
  void drag(const LiquidState&, Eigen::VectorXd&) override { fail(); }
  void mixing_squares(const LiquidState&, Eigen::VectorXd&) override { fail(); }
  void color_slope(const LiquidState&, Eigen::Matrix3Xd&) override { fail(); }
  void conduction(const LiquidState&, const Eigen::VectorXd&, const Eigen::MatrixXd&,
                  Eigen::VectorXd&) override {
    fail();
  }

 private:
  static void fail() { throw DeviceFailure("out of memory"); }
};

TEST_F(DeviceLiquidForces, WhereTheDeviceFailsTheCpuGoesOn) {
  const Forces exact = forces(cpu_, nullptr);
  device_.set_device(std::make_unique<FailingLiquid>());
  EXPECT_EQ(forces(device_, nullptr), exact);
  ASSERT_EQ(report_.warnings.size(), 1u);
  EXPECT_NE(report_.warnings[0].find("out of memory"), std::string::npos);
  EXPECT_FALSE(device_.has_device());
  EXPECT_EQ(forces(device_, nullptr), exact);
  EXPECT_TRUE(report_.warnings.empty());
}

}  // namespace
}  // namespace pliant
