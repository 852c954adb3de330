#include "support/stability_worlds.h"

namespace pliant {
namespace {

using CornerPins = HardCase;

// 100 x 100 particles held by two corners, with the solver's default iterations. The strain of the threads
// at a corner is reported. Its bound is energy: what the threads store was gravity's work, and
// all of it in the one weakest thread, k = 250 N/m, l = 1 cm, would be E = k (l e)² / 2.
TEST_P(CornerPins, StretchNoFurtherThanGravitysWorkAllows) {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 100, 100};
  scene.effects = {{"gravity", {}}, {"damping", {}}};
  scene.fixed = {vertex(scene.grid, 99, 0), vertex(scene.grid, 99, 99)};
  scene.solver = solver();
  const auto world = make_stable_world(scene);
  const double seconds = iterates(solver()) ? 0.3 : 0.1;
  double largest = 0.0, highest_energy = 0.0;
  while (world->time() < seconds) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    largest = std::max(largest, largest_strain(*world));
    highest_energy = std::max(highest_energy, world->energies().total());
  }
  const double work = -world->energies().potential;
  RecordProperty("largest_strain", std::to_string(largest));
  RecordProperty("highest_energy", std::to_string(highest_energy));
  RecordProperty("work", std::to_string(work));
  EXPECT_LE(0.5 * 250.0 * std::pow(0.0101 * largest, 2), work);
}

PLIANT_FOR_EVERY_CLOTH_SOLVER(CornerPins);

}  // namespace
}  // namespace pliant
