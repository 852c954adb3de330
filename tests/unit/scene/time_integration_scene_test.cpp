// The key time_integration of a scene and of its bodies.
#include <gtest/gtest.h>

#include "pliant/core/step/body_integration.h"
#include "pliant/math/error.h"
#include "support/worlds/body_pairs.h"

namespace pliant::time_integration_scene_test {
namespace {

const char* const kApart = "  gravity: {}\n";
const char* const kTouch = "  gravity: {}\n  body_contact: {}\n";

std::string integration_of(World& world, const std::string& body) {
  return std::string(time_integration_of(body_named(world, body)));
}

std::vector<std::string> warnings_of(const std::string& text) {
  const SceneFiles files;
  return load_scene(files.write("scene.yaml", text)).warnings;
}

TEST(SceneTimeIntegration, IsThatOfAllBodiesButThoseThatNameTheirOwn) {
  const auto world = world_of(scene_text(
      {slab("sheet", "cloth", 0.2), slab("block", "patch", 0.1, "time_integration: midpoint"),
       slab("other", "patch", 0.05)},
      kApart, "time_integration: bdf2\n"));
  EXPECT_EQ(integration_of(*world, "sheet"), "bdf2");
  EXPECT_EQ(integration_of(*world, "block"), "midpoint");
  EXPECT_EQ(integration_of(*world, "other"), "bdf2");
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_named(*world, "sheet").report.time_integration, "bdf2");
  EXPECT_EQ(body_named(*world, "sheet").report.first_order, "start");
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_named(*world, "sheet").report.first_order, "");
}

TEST(SceneTimeIntegration, IsImplicitEulerWithoutTheKey) {
  const auto world = world_of(scene_text({slab("sheet", "cloth", 0.2)}, kApart));
  EXPECT_EQ(integration_of(*world, "sheet"), "implicit_euler");
  const auto explicit_one =
      world_of(scene_text({slab("sheet", "cloth", 0.2)}, kApart, "solver: {name: verlet}\n"));
  EXPECT_EQ(integration_of(*explicit_one, "sheet"), "");
}

TEST(SceneTimeIntegration, BodiesThatTouchShareIt) {
  const std::vector<std::string> bodies = {slab("one", "patch", 0.2, "time_integration: bdf2"),
                                           slab("other", "patch", 0.05)};
  const auto world = world_of(scene_text(bodies, kTouch));
  EXPECT_EQ(integration_of(*world, "other"), "bdf2");
  const std::string text = refusal(
      scene_text({bodies[0], slab("other", "patch", 0.05, "time_integration: midpoint")}, kTouch));
  EXPECT_TRUE(has(text, "'one' and 'other' may touch and are moved together")) << text;
}

TEST(SceneTimeIntegration, BodiesWithTheirOwnAreWarnedOf) {
  const std::string warning = "time_integration 'bdf2' is not that of body 'box', since the model";
  const auto count = [&](const std::string& keys) {
    int found = 0;
    for (const std::string& told : warnings_of(
             scene_text({slab("sheet", "cloth", 0.2), slab("box", "rigid", 0.05)}, kApart, keys))) {
      if (told.find(warning) == 0) ++found;
    }
    return found;
  };
  EXPECT_EQ(count("time_integration: bdf2\n"), 1);
  EXPECT_EQ(count("time_integration: implicit_euler\n"), 0);
  EXPECT_EQ(count(""), 0);
}

TEST(SceneTimeIntegration, IsRefusedWithItsPlaceWhereItCannotBe) {
  const auto sheet = [](const std::string& keys) { return slab("sheet", "cloth", 0.2, keys); };
  struct Bad {
    std::string scene, words;
  };
  const std::vector<Bad> all = {
      {scene_text({sheet("")}, kApart, "time_integration: bdf3\n"), "did you mean 'bdf2'"},
      {scene_text({sheet("")}, kApart, "time_integration: {name: bdf2}\n"), "time_integration"},
      {scene_text({sheet("time_integration: midpont")}, kApart), "did you mean 'midpoint'"},
      {scene_text({slab("box", "rigid", 0.2, "time_integration: bdf2")}, kApart),
       "bodies[0].time_integration"},
      {scene_text({slab("box", "rigid", 0.2)}, kApart, "time_integration: bdf2\n"),
       "'box' is of the model 'rigid'"},
      {scene_text({sheet("")}, kApart, "solver: {name: verlet}\ntime_integration: bdf2\n"),
       "'verlet' has a time integration of its own"}};
  for (const Bad& bad : all) {
    const std::string text = refusal(bad.scene);
    EXPECT_TRUE(has(text, bad.words)) << text;
    EXPECT_TRUE(has(text, "time_integration")) << text;
    EXPECT_TRUE(has(text, "scene.yaml:")) << text;
  }
}

TEST(SceneTimeIntegration, SolversThatTakeTurnsAreOfFirstOrderAndSaySo) {
  const std::string xpbd = "solver: {name: xpbd, iterations: 20}";
  const auto world =
      world_of(scene_text({slab("sheet", "cloth", 0.2, xpbd + ", time_integration: bdf2"),
                           slab("block", "patch", 0.05, "solver: {name: direct}")},
                          kTouch));
  ASSERT_TRUE(world->step());
  const StepReport& report = body_named(*world, "sheet").report;
  EXPECT_EQ(report.first_order, "solvers");
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_EQ(report.warnings.front().find("time_integration_ignored: "), 0u);
}

TEST(SceneTimeIntegration, IsOverridden) {
  const SceneFiles files;
  const std::string path =
      files.write("scene.yaml",
                  scene_text({slab("sheet", "cloth", 0.2, "time_integration: midpoint")}, kApart));
  SceneOverrides overrides;
  overrides.time_integration = "bdf2";
  EXPECT_EQ(integration_of(*load_scene(path, overrides).world, "sheet"), "bdf2");
  overrides.time_integration = "bdf";
  EXPECT_THROW(load_scene(path, overrides), InputError);
}

}  // namespace
}  // namespace pliant::time_integration_scene_test
