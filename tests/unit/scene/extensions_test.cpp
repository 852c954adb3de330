// What is built and loaded is tests/build/installed_library's.
#include "pliant/scene/extensions.h"

#include <gtest/gtest.h>

#include "pliant/effects/gravity.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

TEST(Extensions, AreLoadedFromAbsolutePathsAlone) {
  for (const char* file : {"libm.so.6", "./libmagnet.so", "folder/libmagnet.so", ""}) {
    expect_refusal([&] { load_extension(file); }, {"absolute path"});
  }
}

TEST(Extensions, ThatAreMissingOrNoneAreRefused) {
  expect_refusal([] { load_extension("/nowhere/libmagnet.so"); },
                 {"/nowhere/libmagnet.so", "No such file", "PLIANT_EXTENSION"});
  expect_refusal([] { load_extension("/proc/self/exe"); }, {"PLIANT_EXTENSION"});
}

TEST(Extensions, MayNotTakeANameThatIsThere) {
  const std::size_t count = effect_registry().entries().size();
  expect_refusal([] { add_effect(gravity_entry()); }, {"effect 'gravity' is there already"});
  expect_refusal([] { add_solver(solver_registry().find("newton")); }, {"solver 'newton'"});
  EXPECT_EQ(effect_registry().entries().size(), count);
}

/// Whether a cloth falls, moved by an added solver "mine" that is xpbd.
bool mine_moves_a_cloth() {
  SolverRegistry::Entry mine = solver_registry().find("xpbd");
  mine.name = "mine";
  add_solver(mine);
  SceneOverrides overrides;
  overrides.text =
      "time_step: 0.005\nsolver: {name: mine, iterations: 5}\nbodies:\n"
      "  - {name: a, model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [4, 4]}}}\n"
      "effects:\n  gravity: {}\n";
  LoadedScene scene = load_scene("scene.yaml", overrides);
  return scene.world->step() && scene.world->bodies()[0].particles().v.row(2).maxCoeff() < -0.01;
}

// In a process of its own: what is added stays.
TEST(Extensions, AnAddedSolverMovesBodies) {
  EXPECT_EXIT(std::exit(mine_moves_a_cloth() ? 0 : 1), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace pliant
