// A cloth folded in four is pressed and let go: nothing passes, by an independent test of every
// edge with every triangle.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "support/meshes/intersections.h"
#include "support/solvers/stable_step.h"

namespace pliant::folded_cloth_test {
namespace {

constexpr double kThickness = 0.004;              // [m]
constexpr GridOptions kGrid{0.18, 0.18, 13, 13};  // cells of 15 mm

/// Folded across x and then across y into four layers that are `gap` apart; at the folds, which are
/// sharper than the cells, a row of vertices lies beyond the layers.
void fold_in_four(Positions& x, double gap) {
  for (auto p : x.colwise()) {
    const double across = p.x(), along = p.y();
    const bool on_first = std::abs(across) < 1e-9, on_second = std::abs(along) < 1e-9;
    double layer = on_first ? 0.5 : (across > 0.0 ? 1.0 : 0.0);
    p.x() = on_first ? 0.5 * gap : -std::abs(across);
    if (on_second) {
      p.y() = gap * (1.0 - layer);
      layer = 1.5;
    } else if (along > 0.0) {
      p.y() = -along;
      layer = 3.0 - layer;
    }
    p.z() += layer * gap;
  }
}

class FoldedCloth : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(FoldedCloth);

TEST_P(FoldedCloth, InFourAndPressedStaysUntangled) {
  ClothScene scene;
  scene.grid = kGrid;
  scene.material = {
      {"stretch_warp", "500"}, {"stretch_weft", "500"}, {"shear", "50"}, {"bending", "1e-5"}};
  scene.pose = at(0, 0, 0.5 * kThickness);
  scene.obstacles = {obstacle(Plane()), obstacle(Box({0.4, 0.4, 0.02}), at(0, 0, 0.035))};
  scene.effects = {{"gravity", {}},
                   {"damping", {{"rate", "2"}}},
                   {"self_contact", {{"thickness", std::to_string(kThickness)}}},
                   {"contact", {{"thickness", std::to_string(kThickness)}}},
                   {"friction", {}}};
  scene.solver = solver();
  scene.solver_parameters = few_iterations(solver(), 20);
  const auto world = make_stable_world(scene);
  Positions& x = particles_of(*world).x;
  fold_in_four(x, kThickness);
  world->set_initial_state();
  const auto tangled = [&] {
    return count_intersections(x, body_of(*world).model->surface_triangles());
  };
  ASSERT_EQ(tangled(), 0) << "the scene begins tangled";
  // The plate comes down to 4.5 thicknesses above the table in 0.07 s, rests and rises.
  const double lowest_plate = 4.5 * kThickness + 0.01;
  double highest = 0.0;
  for (int step = 0; world->time() < 0.25; ++step) {
    double& plate = world->obstacles()[1].pose_end.translation().z();
    const double travel = 0.1 * world->time_step();
    plate = world->time() < 0.2 ? std::max(lowest_plate, plate - travel) : plate + travel;
    ASSERT_TRUE(world->step()) << world->failure();
    if (std::abs(plate - lowest_plate) < travel) highest = x.row(2).maxCoeff();
    if (step % (is_explicit(scene.solver) ? 100 : 10) != 0) continue;
    ASSERT_EQ(tangled(), 0) << step;
  }
  EXPECT_EQ(tangled(), 0);
  EXPECT_LT(highest, 4.5 * kThickness) << "it was pressed";
  EXPECT_LT(extent(*world), 0.3) << "it burst";
}

}  // namespace
}  // namespace pliant::folded_cloth_test
