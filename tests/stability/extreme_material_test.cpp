// Extreme stiffness and size.
#include "support/solvers/stable_step.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class ExtremeMaterial : public EverySolver {
 protected:
  /// A cloth of default fabric on two corners.
  ClothScene scene() const {
    ClothScene s;
    s.solver = solver();
    s.fixed = {0, 6};
    s.effects = {{"gravity", {}}, {"damping", {{"rate", "2"}}}};
    return s;
  }
  /// The same, its triangles `shear` times as long as they are high.
  void expect_no_free_motion_of_triangles(double shear, bool over_floor = false) const {
    ClothScene s = scene();
    if (over_floor) {
      s.effects.push_back({"contact", {}});
      s.obstacles = {obstacle(Plane(), at(0.0, 0.0, -5.0))};
    }
    BodyGeometry geometry{make_grid(s.grid), {}};
    geometry.mesh.vertices.row(0) += shear * geometry.mesh.vertices.row(1);
    const auto world = make_stable_world(s, geometry);
    const double scale = particles_of(*world).mass.sum() * 9.81 * 0.3;
    expect_no_free_motion(*world, 300 * world->time_step(), 1e-12 * scale);
  }
};
PLIANT_FOR_EVERY_SOLVER(ExtremeMaterial);

// Yarns that nothing keeps at right angles: shear is a motion without energy.
TEST_P(ExtremeMaterial, WithoutShearOrBending) {
  ClothScene s = scene();
  s.material = {{"shear", "0"}, {"bending", "0"}};
  const auto world = make_stable_world(s);
  expect_no_free_motion(*world, 3.0, 1e-12);
  // It sways out: of the energy of the fall by 0.3 m at the most, damping leaves exp(-2 t).
  const double fall = particles_of(*world).mass.sum() * 9.81 * 0.3;
  EXPECT_LT(world->energies().kinetic, fall * std::exp(-2.0 * world->time()));
}

// Springs that hold nothing: it falls as stones do. At 1.3 m, the furthest a neighbour gets away
// from a pin, the eight springs of a vertex pull with 1e-5 N: 0.04 m/s² for the lightest, 5 mm.
TEST_P(ExtremeMaterial, SoftAsNothing) {
  ClothScene s = scene();
  s.material = {
      {"stretch_warp", "1e-6"}, {"stretch_weft", "1e-6"}, {"shear", "1e-6"}, {"bending", "0"}};
  s.effects = {{"gravity", {}}};
  const auto world = make_world(s);
  run_for(*world, 0.5);
  const double t = world->time(), fall = -0.5 * 9.81 * t * (t + world->time_step());
  for (int i = 0; i < particles_of(*world).size(); ++i) {
    if (particles_of(*world).is_fixed(i)) continue;
    ASSERT_NEAR(particles_of(*world).x(2, i), fall, 0.02) << i;
  }
}

TEST_P(ExtremeMaterial, AsLargeAsAFieldAndAsSmallAsAStamp) {
  for (const double size : {100.0, 0.01}) {
    SCOPED_TRACE(size);
    ClothScene s = scene();
    s.grid = {size, size, 7, 7};
    const auto world = make_stable_world(s);
    const double scale = particles_of(*world).mass.sum() * 9.81 * size;
    expect_no_free_motion(*world, 300 * world->time_step(), 1e-12 * scale);
  }
}

// Triangles with angles of 5 and 175 degrees: the largest eigenvalue of D^-1 A is near 4 there.
TEST_P(ExtremeMaterial, OfSliversAndObtuseTriangles) { expect_no_free_motion_of_triangles(12.0); }

// What might be touched and is not changes nothing.
TEST_P(ExtremeMaterial, OfSliversHighOverAFloor) { expect_no_free_motion_of_triangles(12.0, true); }

// Warp and weft begin to move as one.
TEST_P(ExtremeMaterial, OfTrianglesOnTheWayToSlivers) { expect_no_free_motion_of_triangles(1.5); }

class StiffAsSteel : public EverySolver {
 protected:
  ClothScene scene() const {
    ClothScene s;
    s.solver = solver();
    s.fixed = {0, 6};
    s.time_step = 1.0 / 60;
    s.effects = {{"gravity", {}}, {"damping", {}}};
    s.material = {
        {"stretch_warp", "1e9"}, {"stretch_weft", "1e9"}, {"shear", "1e9"}, {"bending", "100"}};
    return s;
  }
};
class StiffAsSteelExplicit : public StiffAsSteel {};
PLIANT_FOR_IMPLICIT_SOLVERS(StiffAsSteel);
PLIANT_FOR_EXPLICIT_SOLVERS(StiffAsSteelExplicit);

TEST_P(StiffAsSteel, IsBounded) {
  const auto world = make_world(scene());
  expect_no_free_motion(*world, 2.0, 1e-12);
  EXPECT_LT(extent(*world), 0.6);
}

TEST_P(StiffAsSteelExplicit, IsToldAndUndone) {
  const auto world = make_world(scene());
  bool good = true;
  for (int k = 0; k < 20 && good; ++k) good = world->step();
  EXPECT_TRUE(warns(*world, "unstable_step"));
  EXPECT_FALSE(good);
  EXPECT_TRUE(particles_of(*world).x.allFinite());
}

}  // namespace
}  // namespace pliant
