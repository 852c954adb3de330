// Air under a rigid sheet over any obstacle, in closed form: force against height, volumes, leak,
// and bubbles that split, merge and vanish.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "pliant/effects/air/air.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/scene/scene.h"
#include "support/measures.h"
#include "support/worlds/sheets.h"
#include "support/worlds/worlds.h"

namespace pliant::bubbles_test {
namespace {

constexpr double kAtmosphere = 101325.0;  // [Pa]

/// A rigid disc, 3 mm over the top of something flat, with air at the atmosphere's pressure below.
struct LiftedDisc {
  static constexpr double kRadius = 0.1, kHeight = 0.003;  // [m]

  LiftedDisc(const Obstacle& below, double top, const ParameterText& air, double dt = 1e-3)
      : mesh(disc(kRadius, 6, 64)), area_(area(mesh)) {
    mesh.vertices.row(2).array() += top + kHeight;
    ParameterText all = {{"volume", std::to_string(area_ * kHeight)}, {"seal_breaks", "false"}};
    for (const auto& [name, value] : air) all[name] = value;
    world = sheet_world(mesh, {below}, {{"air", all}}, dt);
    make_rigid(*world);
  }
  AirEffect& air() { return effect_of<AirEffect>(*world, "air"); }
  void lift(double rise) {
    particles_of(*world).x.row(2).array() += rise;
    ASSERT_TRUE(world->step());
  }

  TriangleMesh mesh;
  double area_;
  std::unique_ptr<World> world;
};

// F = p_a A (1 - (h_0/h)^gamma), the atmosphere's weight less the air's.
TEST(Bubbles, ARigidDiscIsHeldByBoylesLaw) {
  struct Gas {
    const char* name;
    double exponent;
  };
  const std::vector<std::pair<Obstacle, double>> grounds = {
      {obstacle(Plane()), 0.0},
      {obstacle(Box({0.5, 0.5, 0.2})), 0.1},
      {obstacle(Cylinder(0.3, 0.2)), 0.1},
  };
  for (const auto& [ground, top] : grounds) {
    for (const Gas gas : {Gas{"isothermal", 1.0}, Gas{"adiabatic", 1.4}}) {
      SCOPED_TRACE(ground.name + std::string(" ") + gas.name);
      LiftedDisc d(ground, top, {{"gas", gas.name}});
      for (int k = 1; k <= 20; ++k) {
        d.lift(5e-4);
        const double h = LiftedDisc::kHeight + k * 5e-4;
        const double wanted = kAtmosphere * M_PI * LiftedDisc::kRadius * LiftedDisc::kRadius *
                              (1.0 - std::pow(LiftedDisc::kHeight / h, gas.exponent));
        // The obstacle is pulled up as much as the disc is pulled down. The disc is a polygon of 64
        // sides, 0.16 % smaller.
        EXPECT_NEAR(d.world->reactions()[0].force.z(), wanted, 0.01 * wanted) << h;
      }
    }
  }
}

/// A cap of a sphere of radius `radius` about the origin, of half the angle `angle`.
TriangleMesh cap(double radius, double angle, int rings) {
  TriangleMesh mesh = disc(1.0, rings, 6 * rings);
  for (auto p : mesh.vertices.colwise()) {
    const double t = angle * p.norm(), turn = std::atan2(p.y(), p.x());
    p = radius *
        Eigen::Vector3d(std::sin(t) * std::cos(turn), std::sin(t) * std::sin(turn), std::cos(t));
  }
  return mesh;
}

TEST(Bubbles, TheVolumeOverASphereIsOfSecondOrder) {
  constexpr double kInner = 0.1, kOuter = 0.12, kAngle = 1.0;
  const double exact =
      2.0 * M_PI / 3.0 * (1.0 - std::cos(kAngle)) * (std::pow(kOuter, 3) - std::pow(kInner, 3));
  double before = 0.0;
  for (const int rings : {4, 8, 16, 32}) {
    const auto world =
        sheet_world(cap(kOuter, kAngle, rings), {obstacle(Sphere(kInner))}, {{"air", {}}}, 1e-3);
    const double error =
        std::abs(effect_of<AirEffect>(*world, "air").volume(particles_of(*world).x) - exact);
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.4) << rings;
    }
    before = error;
  }
  EXPECT_LT(before, 2e-3 * exact);
}

TEST(Bubbles, TheVolumeOverAMeshIsThatOverItsShape) {
  constexpr double kInner = 0.1, kOuter = 0.12;
  const auto volume = [&](const Obstacle& below) {
    const auto world = sheet_world(cap(kOuter, 1.0, 12), {below}, {{"air", {}}}, 1e-3);
    return effect_of<AirEffect>(*world, "air").volume(particles_of(*world).x);
  };
  const double exact = volume(obstacle(Sphere(kInner)));
  const MeshShape mesh(Sphere(kInner).surface());
  // Distances are good to the voxels' size squared times curvature, and the displayed sphere is a
  // polyhedron inside of it.
  const double area = 2.0 * M_PI * (1.0 - std::cos(1.0)) * kInner * kInner;
  EXPECT_NEAR(volume(obstacle(mesh)), exact, 0.01 * area * kInner);
}

// Turned inside out the winding says nothing: below is where the obstacle is.
TEST(Bubbles, TheVolumeDoesNotDependOnTheWinding) {
  TriangleMesh mesh = cap(0.12, 1.0, 6);
  const auto volume = [&] {
    const auto world = sheet_world(mesh, {obstacle(Sphere(0.1))}, {{"air", {}}}, 1e-3);
    return effect_of<AirEffect>(*world, "air").volume(particles_of(*world).x);
  };
  const double right = volume();
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  EXPECT_EQ(volume(), right);
  EXPECT_GT(right, 0.0);
}

// dV_0/dt = -k A (p - p_a) with p = p_a V_0/V at constant V: V_0 - V falls as exp(-k A p_a t/V).
TEST(Bubbles, LeaksThroughTheWeaveAndTheEdgeByDarcysLaw) {
  const double weave = M_PI * 0.01, edge = 2.0 * M_PI * 0.1;  // of the disc [m², m]
  for (const bool by_edge : {false, true}) {
    SCOPED_TRACE(by_edge ? "edge" : "weave");
    constexpr double kLeak = 1e-8, kStep = 1e-3, kTime = 0.2;
    const double rate =
        kLeak * (by_edge ? edge : weave) * kAtmosphere / (M_PI * 0.01 * LiftedDisc::kHeight);
    LiftedDisc d(obstacle(Plane()), 0.0,
                 {{"volume", "1.2e-4"}, {by_edge ? "edge_leak" : "permeability", "1e-8"}}, kStep);
    const double volume = d.area_ * LiftedDisc::kHeight, start = 1.2e-4 - volume;
    for (double t = 0.0; t < kTime - 0.5 * kStep; t += kStep) d.lift(0.0);
    const double wanted = start * std::exp(-rate * kTime);
    // Implicit Euler loses rate² h t/2 of it; the polygon of 64 sides 0.2 % of area and length.
    const double lost = 0.5 * rate * rate * kStep * kTime + 4e-3 * rate * kTime;
    EXPECT_NEAR(d.air().amount() - volume, wanted, lost * wanted);
    EXPECT_LT(wanted, 0.95 * start) << "it leaks too little to say anything";
  }
}

/// A rigid sheet that is one dome, two domes, and one again.
class TwoDomes {
 public:
  TwoDomes() : mesh_(make_grid({0.3, 0.3, 31, 31})) {
    mesh_.vertices.row(2).setZero();
    rest_ = mesh_.vertices;
    shape(mesh_.vertices, 0.0, 1.0);
    world_ = sheet_world(mesh_, {obstacle(Plane())},
                         {{"air", {{"volume", "1e-4"}, {"seal_breaks", "false"}}}}, 1e-3);
    make_rigid(*world_);
  }
  AirEffect& air() { return effect_of<AirEffect>(*world_, "air"); }
  World& world() { return *world_; }

  /// `waist` from 0, one dome, to 1, two that a flat strip parts.
  void move(double waist, double height) {
    shape(particles_of(*world_).x, waist, height);
    ASSERT_TRUE(world_->step());
  }
  double worst() {
    double worst = 0.0;
    for (const Bubble& bubble : air().bubbles()) {
      const double v = air().volume(bubble, particles_of(*world_).x);
      worst =
          std::max(worst, std::abs((kAtmosphere + bubble.gauge) * v / kAtmosphere - bubble.amount));
    }
    return worst;
  }

 private:
  void shape(Positions& x, double waist, double height) const {
    for (int i = 0; i < x.cols(); ++i) {
      const double u = rest_(0, i) / 0.15, v = rest_(1, i) / 0.15;
      const double dome = (1.0 - u * u) * (1.0 - v * v);
      const double strip = std::max(0.0, 1.0 - waist * 1.2 * std::exp(-50.0 * u * u));
      x(2, i) = 0.01 * height * dome * (u < 0.0 ? 1.0 : 0.5 + 0.5 * strip) * strip;
    }
  }

  TriangleMesh mesh_;
  Positions rest_;
  std::unique_ptr<World> world_;
};

TEST(Bubbles, KeepTheirAirThroughSplitAndMerge) {
  TwoDomes d;
  std::size_t most = 0;
  for (int round = 0; round < 2; ++round) {
    for (int k = 0; k <= 40; ++k) {
      d.move(k <= 20 ? k / 20.0 : 2.0 - k / 20.0, 1.0);
      const auto& bubbles = d.air().bubbles();
      most = std::max(most, bubbles.size());
      const double sum = std::accumulate(
          bubbles.begin(), bubbles.end(), 0.0,
          [](double so_far, const Bubble& bubble) { return so_far + bubble.amount; });
      EXPECT_NEAR(sum, 1e-4, 1e-6 * 1e-4) << k;
      EXPECT_LE(d.worst(), 1e-6 * 1e-4) << k;
    }
    EXPECT_EQ(d.air().bubbles().size(), 1u);
  }
  EXPECT_EQ(most, 2u);
}

// A split does not change the pressure, whatever the sizes.
TEST(Bubbles, SplitAtOnePressure) {
  TwoDomes d;
  double before = 0.0;
  for (int k = 0; k <= 20; ++k) {
    d.move(k / 20.0, 1.0);
    const auto& bubbles = d.air().bubbles();
    if (bubbles.size() == 1) {
      before = bubbles.front().gauge;
      continue;
    }
    // Since then both were squeezed a little by the step that parted them.
    EXPECT_NEAR(bubbles[0].gauge, bubbles[1].gauge, 0.02 * (kAtmosphere + before));
    return;
  }
  FAIL() << "it did not split";
}

TEST(Bubbles, VanishedAirComesBack) {
  TwoDomes d;
  for (const double height : {1.0, 0.5, 0.1, 0.0, 0.0, 0.1, 1.0}) {
    d.move(0.0, height);
    EXPECT_NEAR(d.air().amount(), 1e-4, 1e-10);
    for (const Bubble& bubble : d.air().bubbles()) EXPECT_TRUE(std::isfinite(bubble.gauge));
  }
  EXPECT_LE(d.worst(), 1e-6 * 1e-4);
}

// Water holds its edge down, as cloth that lies there dry would not.
TEST(Bubbles, TheSealedClothThatShipsKeepsItsAir) {
  const LoadedScene scene =
      load_scene(std::string(PLIANT_SOURCE_DIR) + "/config/scenes/sealed_cloth.yaml");
  World& world = *scene.world;
  const auto& air = effect_of<AirEffect>(world, "air");
  while (world.time() < 0.6) {
    ASSERT_TRUE(world.step());
    ASSERT_FALSE(warns(world, "air_escapes")) << world.time();
  }
  EXPECT_NEAR(air.amount(), 2e-4, 1e-12);
  EXPECT_NEAR(air.volume(particles_of(world).x), 2e-4, 1e-6);
}

TEST(Bubbles, AStateInTheMiddleOfASplitGoesOnBitForBit) {
  TwoDomes d;
  for (int k = 0; k <= 20; ++k) d.move(k / 20.0, 1.0);
  ASSERT_EQ(d.air().bubbles().size(), 2u);
  const Checkpoint saved = d.world().save();
  const auto go_on = [&] {
    for (int k = 19; k >= 10; --k) d.move(k / 20.0, 1.0);
    return d.air().pressure();
  };
  const double first = go_on();
  d.world().load(saved);
  EXPECT_EQ(go_on(), first);
}

// Two domes with a row of lying vertices between them, which triangles of both have: what one
// bubble moves of these must not change the other's volume. Contact's final projection comes after
// the air.
TEST(Bubbles, SideBySideEachKeepsItsProduct) {
  for (const Obstacle& ground :
       {obstacle(Plane()), obstacle(Box({1.0, 1.0, 0.1}), at(0, 0, -0.05))}) {
    ClothScene s;
    s.grid = {0.3, 0.3, 13, 13};
    s.solver = "chebyshev";
    s.solver_parameters = {{"iterations", "200"}};
    s.time_step = 1e-3;
    s.obstacles = {ground};
    s.pose = at(0, 0, 0.001);  // half the thickness: where contact holds it
    s.effects = {{"gravity", {}},
                 {"air", {{"volume", "3e-4"}, {"seal_breaks", "false"}}},
                 {"contact", {{"thickness", "0.002"}}}};
    const auto world = make_world(s);
    for (auto x : particles_of(*world).x.colwise()) {
      x.z() += 0.01 * std::pow(std::sin(2.0 * M_PI * x.x() / 0.3), 2);
    }
    world->set_initial_state();
    const auto& air = effect_of<AirEffect>(*world, "air");
    int beside = 0;
    for (int k = 0; k < 30; ++k) {
      ASSERT_TRUE(world->step()) << world->failure();
      beside += air.bubbles().size() == 2 ? 1 : 0;
      for (const Bubble& bubble : air.bubbles()) {
        const double product =
            (1.0 + bubble.gauge / kAtmosphere) * air.volume(bubble, particles_of(*world).x);
        EXPECT_NEAR(product, bubble.amount, 1e-5 * bubble.amount) << k;
      }
    }
    EXPECT_GT(beside, 0) << "the test says nothing";
  }
}

/// How far a sheet that air lifts off `ground` is from flat, over how far it rose.
double unevenness(const std::string& solver, const Obstacle& ground) {
  ClothScene scene;
  scene.material = soft_material();
  scene.time_step = 0.002;
  scene.obstacles = {ground};
  scene.pose = at(0, 0, 0.001);
  scene.solver = solver;
  scene.effects = {{"gravity", {}},
                   {"air", {{"volume", "3e-4"}, {"fill_time", "0.1"}, {"seal_breaks", "false"}}},
                   {"contact", {{"thickness", "0.002"}}}};
  const auto world = make_world(scene);
  run_for(*world, 0.1);
  const auto heights = particles_of(*world).x.row(2);
  return (heights.maxCoeff() - heights.minCoeff()) / (heights.mean() - 0.001);
}

// Pressure lifts every vertex of a flat sheet as much as its mass takes, those at edges and corners
// too: it rises as a plate. Over a plane pressure acts at the height of an edge too and pulls it
// outwards; the cells there are then stretched, and lifted, by some 1e-4 more than their mass
// takes.
TEST(Bubbles, AFlatSheetRisesFlat) {
  for (const char* solver : {"newton", "chebyshev", "xpbd"}) {
    EXPECT_LE(unevenness(solver, obstacle(Plane())), 1e-3) << solver;
    const Obstacle box = obstacle(Box(Eigen::Vector3d(1, 1, 0.1)), at(0, 0, -0.05));
    EXPECT_LE(unevenness(solver, box), 1e-9) << solver;
  }
}

}  // namespace
}  // namespace pliant::bubbles_test
