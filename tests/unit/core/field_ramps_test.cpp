#include "pliant/core/body/field_ramps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "support/expect_refusal.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

constexpr double kRampsDt = 0.01;

/// All within `radius` of the origin, where the body's first particle is nearest.
FieldRequest request(const std::string& field, double value, double duration, double radius) {
  FieldRequest request;
  request.field = field;
  request.region.kind = Region::Kind::kSphere;
  request.region.radius = radius;
  request.value = value;
  request.duration = duration;
  return request;
}

class FieldRampsTest : public testing::Test {
 protected:
  FieldRampsTest() : t_(lattice_body({4, 1, 1}, 0.01), {}, kRampsDt) {}
  double beta(int particle) { return t_.model().beta()[particle]; }
  void step(int steps) {
    for (int k = 0; k < steps; ++k) ASSERT_TRUE(t_.world().step()) << t_.world().failure();
  }

  ParticleWorld t_;  // particles at x = 0.005, 0.015, 0.025, 0.035 m
};

TEST_F(FieldRampsTest, SetsAtOnceThoseInTheRegionAlone) {
  t_.start();
  EXPECT_EQ(t_.world().set_field(request("beta", 0.5, 0.0, 0.02)), 2);
  EXPECT_EQ(beta(0), 0.5);
  EXPECT_EQ(beta(1), 0.5);
  EXPECT_EQ(beta(2), 0.0);
}

TEST_F(FieldRampsTest, OfOneBodyItLeavesTheOthers) {
  t_.start();
  FieldRequest of_one = request("beta", 0.5, 0.0, 0.02);
  of_one.body = 0;
  EXPECT_EQ(t_.world().set_field(of_one), 2);
  EXPECT_TRUE(has_field(t_.world().bodies().front(), "beta"));
  EXPECT_FALSE(has_field(t_.world().bodies().front(), "bta"));
  EXPECT_TRUE(settable_field_names(t_.world().bodies(), 1).empty()) << "there is no such body";
}

TEST_F(FieldRampsTest, ARampIsEvenAndEndsAtTheValue) {
  t_.start();
  t_.world().set_field(request("beta", 0.8, 4.0 * kRampsDt, 1.0));
  EXPECT_EQ(beta(0), 0.0) << "it begins with the next step";
  for (int k = 1; k <= 6; ++k) {
    step(1);
    EXPECT_NEAR(beta(3), std::min(0.8, 0.2 * k), 1e-12) << k;
  }
}

TEST_F(FieldRampsTest, TheLastRequestForAParticleCounts) {
  t_.start();
  t_.world().set_field(request("beta", 1.0, 4.0 * kRampsDt, 1.0));
  step(2);
  t_.world().set_field(request("beta", 0.1, 0.0, 0.01));
  step(2);
  EXPECT_EQ(beta(0), 0.1) << "no longer on its way";
  EXPECT_EQ(beta(1), 1.0);
}

TEST_F(FieldRampsTest, AResetForgetsAndALoadedStateGoesOn) {
  t_.start();
  t_.world().set_field(request("beta", 0.8, 4.0 * kRampsDt, 1.0));
  step(2);
  const Checkpoint saved = t_.world().save();
  step(1);
  const double later = beta(2);
  t_.world().reset();
  step(3);
  EXPECT_EQ(beta(2), 0.0);
  t_.world().load(saved);
  step(1);
  EXPECT_EQ(beta(2), later);
}

TEST_F(FieldRampsTest, WithHeatTheTemperatureIsSetAndBetaFollows) {
  t_.add_effect("heat",
                {{"initial_temperature", "290"}, {"conductivity", "0"}, {"convection", "0"}});
  t_.start();
  expect_refusal([&] { t_.world().set_field(request("beta", 0.5, 0.0, 1.0)); },
                 {"'beta' cannot be set", "'temperature'"});
  EXPECT_EQ(settable_field_names(t_.world().bodies()), std::vector<std::string>{"temperature"});
  EXPECT_EQ(t_.world().set_field(request("temperature", 305.0, 0.0, 0.02)), 2);
  step(2);
  EXPECT_NEAR(beta(0), 0.5, 1e-9) << "the middle of the melting range";
  EXPECT_EQ(beta(3), 0.0);
}

TEST_F(FieldRampsTest, RefusalsChangeNothing) {
  t_.start();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const FieldRequest& asked, const std::vector<std::string>& parts) {
    expect_refusal([&] { t_.world().set_field(asked); }, parts);
  };
  refused(request("bta", 0.5, 0.0, 1.0), {"set_field", "'bta'", "did you mean 'beta'"});
  refused(request("beta", 1.5, 0.0, 1.0), {"beta", "1.5", ">= 0 and <= 1"});
  refused(request("beta", nan, 0.0, 1.0), {"beta", "finite"});
  refused(request("beta", 0.5, -1.0, 1.0), {"'duration'", "-1"});
  refused(request("beta", 0.5, nan, 1.0), {"'duration'"});
  refused(request("beta", 0.5, 0.0, 1e-4), {"no vertex", "nearest vertex is"});
  FieldRequest listed = request("beta", 0.5, 0.0, 1.0);
  listed.region = Region();
  listed.region.vertices = {1, 4};
  refused(listed, {"no vertex 4", "last one is 3"});
  EXPECT_EQ(t_.model().beta().maxCoeff(), 0.0);
}

}  // namespace
}  // namespace pliant
