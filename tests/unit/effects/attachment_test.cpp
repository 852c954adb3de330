#include "pliant/effects/attachment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"
#include "support/worlds/drivers.h"
#include "support/worlds/reduced_worlds.h"

namespace pliant {
namespace {

/// A sheet that falls, a ball that moves.
std::unique_ptr<World> falling(const std::string& solver = "newton") {
  ClothScene s;
  s.grid = {0.2, 0.2, 3, 3};
  s.material = soft_material();
  s.obstacles = {obstacle(Sphere(0.05), at(0.0, 0.0, -1.0))};
  s.effects = {{"gravity", {}}};
  s.solver = solver;
  s.time_step = 0.01;
  auto world = make_world(s);
  world->add_driver(
      std::make_unique<StraightDriver>(0, at(0.0, 0.0, -1.0), Eigen::Vector3d(1, 0, 0), 100.0));
  return world;
}

AttachmentRequest request(const World& world, double from = 0.0) {
  AttachmentRequest request;
  request.name = "hook";
  request.region.vertices = {0, 1};
  request.count = world.bodies().front().particles().size();
  request.stiffness = 100.0;
  request.from = from;
  return request;
}

AttachmentEffect& effect(World& world) { return attachments_of(body_of(world), world.obstacles()); }

int held(World& world) {
  std::vector<Eigen::Vector3d> points;
  effect(world).add_held(points);
  return static_cast<int>(points.size());
}

TEST(Attachment, LastsFromItsTimeUntilItsEnd) {
  auto world = falling();
  AttachmentRequest wanted = request(*world, 0.1);
  wanted.until = 0.2;
  effect(*world).add(wanted);
  for (int step = 1; step <= 30; ++step) {
    ASSERT_TRUE(world->step());
    EXPECT_EQ(held(*world), step > 10 && step <= 20 ? 2 : 0) << step;
  }
}

TEST(Attachment, HoldsVerticesWhereTheyAreWhenItBegins) {
  auto world = falling();
  effect(*world).add(request(*world, 0.1));
  run_for(*world, 0.1);
  const Positions x = particles_of(*world).x;
  EXPECT_LT(x(2, 0), -0.04);
  run_for(*world, 0.01);
  std::vector<Eigen::Vector3d> points;
  effect(*world).add_held(points);
  // One step: at most what it fell on by, less what the springs took.
  EXPECT_LE((points[0] - x.col(0)).norm(), 0.012);
}

TEST(Attachment, PushesItsObstacleAsMuchAsItHolds) {
  auto world = falling();
  AttachmentRequest wanted = request(*world);
  wanted.obstacle = 0;
  effect(*world).add(wanted);
  for (int step = 0; step < 20; ++step) {
    const Eigen::Vector3d before = particles_of(*world).momentum();
    ASSERT_TRUE(world->step());
    const Eigen::Vector3d change = particles_of(*world).momentum() - before;
    const double mass = particles_of(*world).mass.sum();
    const Eigen::Vector3d expected =
        Eigen::Vector3d(0, 0, -9.81 * mass) - change / world->time_step();
    EXPECT_LE((world->reactions()[0].force - expected).norm(), 1e-6 * mass * 9.81);
  }
}

TEST(Attachment, ResetBringsTheScenesBackAndEndsTheUsers) {
  auto world = falling("direct");
  effect(*world).add(request(*world, 0.05));
  std::vector<Positions> first;
  for (int round = 0; round < 2; ++round) {
    for (std::size_t step = 0; step < 20; ++step) {
      if (round == 0 && step == 15) {
        AttachmentRequest mine = request(*world);
        mine.name = "mine";
        mine.region.vertices = {8};
        first.push_back(particles_of(*world).x);
        effect(*world).attach_now(mine, world->time_step());
        EXPECT_EQ(held(*world), 3);
      }
      ASSERT_TRUE(world->step());
      if (round == 0 && step < 15) first.push_back(particles_of(*world).x);
      if (round == 1 && step < 15) {
        EXPECT_EQ(particles_of(*world).x, first[step]) << step;
      }
    }
    world->reset();
    EXPECT_EQ(held(*world), 0);
    EXPECT_EQ(effect(*world).names(), std::vector<std::string>{"hook"});
  }
}

TEST(Attachment, DetachLetsGoWithoutATrace) {
  auto world = falling(), free = falling();
  effect(*world).attach_now(request(*world), world->time_step());
  effect(*world).detach("hook", world->time_step());
  run_for(*world, 0.2);
  run_for(*free, 0.2);
  EXPECT_EQ(particles_of(*world).x, particles_of(*free).x);
  // And it can be attached again under the same name.
  EXPECT_EQ(effect(*world).attach_now(request(*world), world->time_step()), 2);
}

template <class Scene>
void expect_same_after_load(const Scene& scene, const std::vector<int>& vertices) {
  auto world = make_world(scene);
  AttachmentRequest wanted = request(*world, 0.1);
  wanted.region.vertices = vertices;
  wanted.until = 0.3;
  effect(*world).add(wanted);
  run_for(*world, 0.05);
  wanted.name = "mine";
  wanted.until = std::numeric_limits<double>::infinity();
  effect(*world).attach_now(wanted, world->time_step());
  run_for(*world, 0.15);
  const Checkpoint checkpoint = world->save();
  std::vector<Positions> positions;
  for (int step = 0; step < 30; ++step) {
    ASSERT_TRUE(world->step());
    positions.push_back(particles_of(*world).x);
  }
  effect(*world).detach("mine", world->time_step());
  run_for(*world, 0.02);
  world->load(checkpoint);
  for (const Positions& x : positions) {
    ASSERT_TRUE(world->step());
    ASSERT_EQ(particles_of(*world).x, x) << world->time();
  }
}

TEST(Attachment, SavedStatesOfClothGoOnBitForBit) {
  for (const std::string& solver : cloth_solvers()) {
    SCOPED_TRACE(solver);
    ClothScene s;
    s.grid = {0.2, 0.2, 5, 5};
    s.material = soft_material();
    s.effects = {{"gravity", {}}};
    s.solver = solver;
    s.time_step = 0.0005;
    expect_same_after_load(s, {0, 4});
  }
}

TEST(Attachment, SavedStatesOfReducedBodiesGoOnBitForBit) {
  for (const std::string& solver : reduced_solvers()) {
    SCOPED_TRACE(solver);
    ReducedScene s;
    s.effects = {{"gravity", {}}};
    s.solver = solver;
    s.time_step = 0.0005;
    const Eigen::Matrix3Xd& rest = s.model->mesh.vertices;
    std::vector<int> tip;
    for (int i = 0; i < rest.cols(); ++i) {
      if (rest(0, i) > 0.499) tip.push_back(i);
    }
    expect_same_after_load(s, tip);
  }
}

TEST(Attachment, LeavesFixedVerticesOut) {
  auto world = falling();
  particles_of(*world).fix(0);
  EXPECT_EQ(effect(*world).attach_now(request(*world), world->time_step()), 1);
}

TEST(Attachment, WarnsWhereItFindsNothingLater) {
  auto world = falling();
  AttachmentRequest wanted = request(*world, 0.02);
  wanted.region.kind = Region::Kind::kSphere;
  wanted.region.center = {9.0, 9.0, 9.0};
  wanted.region.radius = 0.1;
  effect(*world).add(wanted);
  run_for(*world, 0.02);
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
  ASSERT_TRUE(world->step());
  ASSERT_EQ(body_of(*world).report.warnings.size(), 1u);
  EXPECT_NE(body_of(*world).report.warnings[0].find("'hook' holds nothing: no vertex is in its"),
            std::string::npos);
}

TEST(Attachment, RefusesBadRequests) {
  auto world = falling();
  const double inf = std::numeric_limits<double>::infinity();
  AttachmentEffect& own = effect(*world);
  const auto refused = [&](const AttachmentRequest& bad, const std::vector<std::string>& words) {
    expect_refusal([&] { own.add(bad); }, words);
    expect_refusal([&] { own.attach_now(bad, 0.01); }, words);
    EXPECT_TRUE(own.names().empty());
  };
  AttachmentRequest bad = request(*world);
  for (double stiffness : {0.0, -1.0, inf, std::nan("")}) {
    bad.stiffness = stiffness;
    refused(bad, {"stiffness", "N/m", "positive"});
  }
  bad = request(*world);
  bad.until = 0.0;
  refused(bad, {"until 0", "end after it began"});
  bad = request(*world);
  bad.region.vertices = {9};
  refused(bad, {"no vertex 9", "last one is 8"});
  bad.region.kind = Region::Kind::kBox;
  bad.region.box = {Eigen::Vector3d(8, 8, 8), Eigen::Vector3d(9, 9, 9)};
  refused(bad, {"no vertex is in its region"});
  for (int i = 0; i < 2; ++i) particles_of(*world).fix(i);
  refused(request(*world), {"all 2 vertices", "fixed"});
  for (int i = 0; i < 2; ++i) particles_of(*world).release(i);
  own.add(request(*world));
  expect_refusal([&] { own.add(request(*world)); }, {"'hook' is taken"});
  expect_refusal([&] { own.detach("hok", 0.01); }, {"did you mean 'hook'"});
  expect_refusal([&] { find_holder("shpere", world->obstacles()); },
                 {"robot link", "did you mean 'sphere'?", "world"});
}

}  // namespace
}  // namespace pliant
