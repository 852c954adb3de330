// Scenes of several bodies: whose solver moves which, and what is refused or warned of.
#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::bodies_together_test {
namespace {

const char* const kTouch = "  gravity: {}\n  body_contact: {}\n";

std::string solver_of(World& world, const std::string& body) {
  return std::string(body_named(world, body).solver->name());
}

std::vector<std::string> warnings_of(const std::string& text) {
  const SceneFiles files;
  return load_scene(files.write("scene.yaml", text)).warnings;
}

TEST(BodiesTogether, WithoutASolverNewtonMovesAll) {
  const auto world = world_of(scene_text(
      {slab("sheet", "cloth", 0.2), slab("box", "rigid", 0.05), slab("block", "patch", 0.12)},
      kTouch));
  ASSERT_TRUE(world->step());
  for (const Body& body : world->bodies()) {
    EXPECT_EQ(body.solver->name(), "newton");
    EXPECT_EQ(body.report.solver, "newton");
    EXPECT_EQ(body.solver, world->bodies().front().solver);
    EXPECT_TRUE(body.report.error.has_value());
  }
}

TEST(BodiesTogether, EachModelTakesItsDefaultWhereNewtonIsNone) {
  // Beside a body that names another, beside bodies of particles, and with air.
  const std::string sheet = slab("sheet", "cloth", 0.2), block = slab("block", "patch", 0.05);
  const auto takes_turns = [](World& world) {
    EXPECT_EQ(solver_of(world, "sheet"), "xpbd");
    EXPECT_EQ(solver_of(world, "block"), "lbfgs");
    ASSERT_TRUE(world.step());
    EXPECT_EQ(world.bodies()[0].report.solver, "xpbd");
    EXPECT_EQ(world.bodies()[1].report.solver, "lbfgs");
  };
  takes_turns(*world_of(
      scene_text({sheet, block, slab("ball", "patch", 0.12, "solver: {name: lbfgs}")}, kTouch)));
  takes_turns(*world_of(scene_text({sheet, block, slab("heap", "viscoelastic", 0.12)}, kTouch)));
  takes_turns(*world_of(
      scene_text({sheet, block}, std::string(kTouch) + "  contact: {}\n  air: {obstacles: table}\n",
                 "obstacles: [{name: table, shape: plane}]\n")));
}

TEST(BodiesTogether, ABodyNamesASolverOfItsOwn) {
  const auto world = world_of(scene_text(
      {slab("one", "patch", 0.2, "solver: {name: newton}"), slab("other", "patch", 0.05)},
      "  gravity: {}\n", "solver: {name: jacobi, iterations: 3}\n"));
  EXPECT_EQ(solver_of(*world, "one"), "newton");
  EXPECT_EQ(solver_of(*world, "other"), "jacobi");
}

TEST(BodiesTogether, TheScenesSolverIsForThoseThatItWorksFor) {
  const std::string heart =
      "  - {name: heart, model: reduced, geometry: {example: {name: heart, scale: 0.03, young: "
      "3.0e+4}}, position: [0, 0, 0.5]}\n";
  const auto world = world_of(scene_text({slab("sheet", "cloth", 0.2), heart}, "  gravity: {}\n",
                                         "solver: {name: jacobi}\n"));
  EXPECT_EQ(solver_of(*world, "sheet"), "jacobi");
  EXPECT_EQ(solver_of(*world, "heart"), "trigonometric");
  EXPECT_TRUE(world->step());
}

TEST(BodiesTogether, OneIsSwappedAlone) {
  const auto world = world_of(scene_text(
      {slab("sheet", "cloth", 0.2, "solver: {name: xpbd}"), slab("block", "patch", 0.05)}, kTouch));
  Body& block = body_named(*world, "block");
  EXPECT_EQ(solver_of(*world, "block"), "lbfgs");
  world->set_solver({&block}, all_solvers(), "newton", {}, "test");
  EXPECT_EQ(solver_of(*world, "block"), "newton");
  EXPECT_EQ(solver_of(*world, "sheet"), "xpbd");
  EXPECT_TRUE(world->step());
  EXPECT_THROW(world->set_solver({&block}, all_solvers(), "jacobi", {}, "test"), InputError);
  EXPECT_EQ(solver_of(*world, "block"), "newton");
  EXPECT_TRUE(world->step());
  world->set_solver(block, all_solvers(), "chebyshev", {}, "test");
  EXPECT_EQ(solver_of(*world, "sheet"), "chebyshev");
  EXPECT_TRUE(world->step());
}

TEST(BodiesTogether, SolversThatCannotGoTogetherAreRefused) {
  const std::string text =
      refusal(scene_text({slab("sheet", "cloth", 0.2, "solver: {name: xpbd}"),
                          slab("block", "patch", 0.05, "solver: {name: jacobi}")},
                         kTouch));
  EXPECT_TRUE(has(text, "jacobi")) << text;
  EXPECT_TRUE(has(text, "block")) << text;
  EXPECT_TRUE(has(refusal(scene_text({slab("a", "patch", 0.2, "solver: {name: lbfgs}"),
                                      slab("b", "patch", 0.05, "solver: {name: newton}")},
                                     kTouch)),
                  "differ"));
}

TEST(BodiesTogether, SweepsOfDifferentNumbersGoTogether) {
  const auto world = world_of(scene_text(
      {slab("sheet", "cloth", 0.06, "solver: {name: xpbd, iterations: 60}"),
       slab("box", "rigid", 0.027, "solver: {name: xpbd, iterations: 20}")},
      "  gravity: {}\n  contact: {}\n  friction: {}\n  damping: {rate: 5}\n  body_contact: {}\n",
      "obstacles: [{name: table, shape: plane}]\n"));
  for (int k = 0; k < 150; ++k) ASSERT_TRUE(world->step());
  const double weight = 9.81 * mass_of(*world, "sheet");
  EXPECT_NEAR(contact_force_on(*world, "sheet").z(), weight, 0.02 * weight);
}

TEST(BodiesTogether, RulesThatSetNothingAreSaid) {
  const auto warnings = [](const std::string& solver) {
    const auto world = world_of(scene_text(
        {slab("sheet", "cloth", 0.2, "solver: " + solver), slab("block", "patch", 0.05)}, kTouch));
    EXPECT_TRUE(world->step());
    return body_named(*world, "sheet").group->first().report.warnings;
  };
  const auto said = warnings("{name: xpbd, iterations: 20, tolerance: 1.0e-3}");
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(has(said[0], "'xpbd' of body 'sheet' set nothing")) << said[0];
  EXPECT_TRUE(warnings("{name: xpbd, iterations: 20}").empty());
}

TEST(BodiesTogether, ASolverOfAnotherModelIsRefused) {
  const std::string text = refusal(scene_text(
      {slab("sheet", "cloth", 0.2, "solver: {name: trigonometric}")}, "  gravity: {}\n"));
  EXPECT_TRUE(has(text, "bodies[0].solver")) << text;
  EXPECT_TRUE(has(text, "does not work for model 'cloth'")) << text;
}

TEST(BodiesTogether, ThoseThatPassThroughEachOtherAreNamed) {
  const std::string text =
      refusal(scene_text({slab("sheet", "cloth", 0.06), slab("block", "patch", 0.05)}, kTouch));
  EXPECT_TRUE(has(text, "of body 'sheet' lie within body 'block' at the start, at (")) << text;
  const std::string through = refusal(scene_text(
      {slab("one", "rigid", 0.1), slab("other", "patch", 0.13, "rotation_rpy: [0.3, 0.2, 0.1]")},
      kTouch));
  EXPECT_TRUE(has(through, "'one'") && has(through, "'other'")) << through;
  EXPECT_TRUE(has(through, "pass through each other at the start, at (")) << through;
}

TEST(BodiesTogether, BodiesThatNothingKeepsApartAreWarnedOf) {
  const auto near = warnings_of(
      scene_text({slab("sheet", "cloth", 0.08), slab("block", "patch", 0.05)}, "  gravity: {}\n"));
  ASSERT_EQ(near.size(), 1u);
  EXPECT_TRUE(has(near[0], "'sheet' and 'block'")) << near[0];
  EXPECT_TRUE(has(near[0], "body_contact")) << near[0];
  for (const std::string& warning : warnings_of(
           scene_text({slab("sheet", "cloth", 0.08), slab("block", "patch", 0.05)}, kTouch))) {
    EXPECT_FALSE(has(warning, "bodies_pass")) << warning;
  }
  EXPECT_TRUE(warnings_of(scene_text({slab("sheet", "cloth", 0.8), slab("block", "patch", 0.05)},
                                     "  gravity: {}\n"))
                  .empty());
}

TEST(BodiesTogether, ThoseThatComeNearLaterAreWarnedOfOnce) {
  const auto world = world_of(
      scene_text({slab("sheet", "cloth", 0.3), slab("block", "rigid", 0.05)}, "  gravity: {}\n"));
  int warned = 0;
  for (int k = 0; k < 100; ++k) {
    if (k < 45) world->bodies()[1].particles().v.setZero();
    ASSERT_TRUE(world->step());
    for (const std::string& warning : world->bodies().front().report.warnings) {
      warned += has(warning, "bodies_pass");
    }
  }
  EXPECT_EQ(warned, 1);
}

TEST(BodiesTogether, AnEffectActsOnTheModelsThatItIsFor) {
  const auto world =
      world_of(scene_text({slab("sheet", "cloth", 0.3), slab("block", "patch", 0.05)},
                          "  gravity: {}\n  volume: {}\n"));
  EXPECT_EQ(body_named(*world, "sheet").find_effect("volume"), nullptr);
  EXPECT_NE(body_named(*world, "block").find_effect("volume"), nullptr);
  EXPECT_NE(refusal(scene_text({slab("sheet", "cloth", 0.3)}, "  volume: {}\n")), "");
}

TEST(BodiesTogether, RigidBodiesHaveNoVerticesToFix) {
  const std::string text = refusal(
      scene_text({slab("block", "rigid", 0.05, "fixed: [{vertices: [0]}]")}, "  gravity: {}\n"));
  EXPECT_TRUE(has(text, "attach it to 'world'")) << text;
}

TEST(BodiesTogether, ContactBetweenFewerThanTwoBodiesIsWarnedOf) {
  const auto warnings = warnings_of(scene_text({slab("block", "patch", 0.05)}, kTouch));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings[0], "not two bodies")) << warnings[0];
}

TEST(BodiesTogether, ReducedBodiesKeepTheirIntegrators) {
  const std::string heart =
      "  - {name: heart, model: reduced, geometry: {example: {name: heart, scale: 0.03, young: "
      "3.0e+4}}, position: [0, 0, 0.09]}\n";
  std::string other = heart;
  other.replace(other.find("heart"), 5, "other").replace(other.find("[0, 0, "), 7, "[0.3, 0, ");
  EXPECT_TRUE(warnings_of(scene_text({slab("block", "patch", 0.02), heart}, kTouch)).empty());
  const auto world = world_of(scene_text({slab("block", "patch", 0.02), heart, other}, kTouch));
  EXPECT_EQ(body_named(*world, "block").solver->name(), "lbfgs");
  EXPECT_EQ(body_named(*world, "heart").solver->name(), "trigonometric");
  // Each has one of its own, since that knows its coordinates.
  EXPECT_NE(body_named(*world, "heart").solver, body_named(*world, "other").solver);
  EXPECT_EQ(body_named(*world, "heart").group, body_named(*world, "other").group);
}

TEST(BodiesTogether, ShapesThatAreNoRigidBodiesAreRefused) {
  const SceneFiles files;
  const auto refused_mesh = [&](const std::string& faces) {
    files.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + faces);
    const std::string body = "  - {name: body, model: rigid, geometry: {mesh: mesh.obj}}\n";
    try {
      load_scene(files.write("scene.yaml", scene_text({body}, "  gravity: {}\n")));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_TRUE(has(refused_mesh("f 1 3 2\nf 1 2 4\nf 1 4 3\n"), "open edge"));
  EXPECT_EQ(refused_mesh("f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"), "") << "it is turned outward";
  EXPECT_EQ(refused_mesh("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"), "");
  const std::string text = refusal(scene_text(
      {"  - {name: body, model: rigid, geometry: {sphere: {radius: -1}}}\n"}, "  gravity: {}\n"));
  EXPECT_TRUE(has(text, "radius")) << text;
}

TEST(BodiesTogether, RigidBodiesNeedASolverThatFindsImpacts) {
  const std::string text = refusal(
      scene_text({slab("block", "rigid", 0.05, "solver: {name: direct}")}, "  gravity: {}\n"));
  EXPECT_TRUE(has(text, "solver 'direct' does not work for model 'rigid'")) << text;
  EXPECT_TRUE(has(text, "xpbd")) << text;
}

TEST(BodiesTogether, AStepThatIsUndoneIsUndoneForAll) {
  const std::string text = scene_text({slab("sheet", "cloth", 0.2), slab("block", "patch", 0.05)},
                                      kTouch, "limits: {max_speed: 5}\n");
  const auto world = world_of(text);
  ASSERT_TRUE(world->step());
  const Positions sheet = body_named(*world, "sheet").particles().x;
  const Positions block = body_named(*world, "block").particles().x;
  throw_away(*world);
  EXPECT_FALSE(world->step());
  EXPECT_EQ(body_named(*world, "sheet").particles().x, sheet);
  EXPECT_EQ(body_named(*world, "block").particles().x, block);
  world->applied_forces().clear();
  EXPECT_TRUE(world->step());
}

TEST(BodiesTogether, AStepInSubstepsIsUndoneForCoordinatesToo) {
  // The liquid takes its steps in substeps, and with it the heart.
  const std::string heart =
      "  - {name: heart, model: reduced, geometry: {example: {name: heart, scale: 0.03, young: "
      "3.0e+4}}, position: [0, 0, 0.0315]}\n";
  const std::string drop =
      "  - {name: drop, model: viscoelastic, geometry: {block: {size: [0.03, 0.03, 0.03]}, "
      "particles: 64}, material: {state: liquid, viscosity: 0.5}, position: [0, 0, 0.12], "
      "velocity: "
      "[0, 0, -4]}\n";
  const std::string text = scene_text({heart, drop}, kTouch, "limits: {max_speed: 30}\n");
  const auto world = world_of(text), other = world_of(text);
  for (int k = 0; k < 4; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_TRUE(other->step());
  }
  ASSERT_GT(body_named(*world, "heart").substeps, 1);
  throw_away(*world);
  EXPECT_FALSE(world->step());
  world->applied_forces().clear();
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_TRUE(other->step());
  }
  for (const char* name : {"heart", "drop"}) {
    EXPECT_EQ(body_named(*world, name).particles().x, body_named(*other, name).particles().x)
        << name;
  }
}

}  // namespace
}  // namespace pliant::bodies_together_test
