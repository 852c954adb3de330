// What a scene says of pairs of bodies.
#include "support/worlds/body_pairs.h"

#include <gtest/gtest.h>

namespace pliant::body_pairs_test {
namespace {

/// Four bodies on the z axis, 2.5 mm apart, and what the effect says of them.
std::string four(const std::string& effect, const std::string& more = "") {
  return scene_text({slab("a", "rigid", 0.05), slab("b", "rigid", 0.1025),
                     slab("c", "rigid", 0.155), slab("tray", "rigid", 0.2075)},
                    "  body_contact: " + effect + "\n", more);
}

std::vector<std::string> near_of(const std::string& text) {
  const SceneFiles files;
  std::vector<std::string> near;
  for (const std::string& warning : load_scene(files.write("scene.yaml", text)).warnings) {
    if (has(warning, "bodies_pass")) near.push_back(warning);
  }
  return near;
}

struct Refused {
  const char* effect;
  std::vector<const char*> parts;  // of the message
};

TEST(BodyPairs, WhatIsNoPairIsRefused) {
  const Refused all[] = {
      {"{pairs: [{bodies: [a, tary]}]}",
       {"scene.yaml:8: effects.body_contact.pairs[0].bodies: unknown body 'tary'",
        "did you mean 'tray'?"}},
      {"{except: [[a, b], [x, c]]}",
       {"scene.yaml:8: effects.body_contact.except[1]: unknown body 'x'", "a, b, c, tray"}},
      {"{except: [[a, table]]}", {"except[0]: 'table' is an obstacle", "'contact'"}},
      {"{pairs: [{bodies: [a]}]}", {"pairs[0].bodies has 1 item, but must be", "two bodies"}},
      {"{except: [[a, b, c]]}", {"except[0] has 3 items, but must be", "two bodies"}},
      {"{except: [a, b]}", {"except[0] is 'a', but must be", "two bodies"}},
      {"{except: []}", {"except is an empty list, but must be a list of [NAME, NAME]"}},
      {"{pairs: {bodies: [a, b]}}", {"pairs is a map, but must be a list"}},
      {"{pairs: [{bodies: [a, a]}]}", {"pairs[0].bodies names body 'a' twice"}},
      {"{except: [[c, c]]}", {"except[0] names body 'c' twice"}},
      {"{pairs: [{bodies: [a, b]}, {bodies: [b, a], friction: 1}]}",
       {"pairs[1]: bodies 'b' and 'a' are named already (", "scene.yaml:8)"}},
      {"{except: [[a, b], [b, a]]}", {"except[1]: bodies 'b' and 'a' are left out already"}},
      {"{pairs: [{bodies: [a, b]}], except: [[b, a]]}",
       {"except[0]: bodies 'b' and 'a' are named under 'pairs' already"}},
      {"{pairs: [{friction: 1}]}", {"pairs[0]: 'bodies' is missing"}},
      {"{pairs: [{bodies: [a, b], frction: 1}]}",
       {"unknown key 'frction' in effects.body_contact.pairs[0]", "did you mean 'friction'?"}},
      {"{pairs: [{bodies: [a, b], friction: -1}]}", {"pairs[0]: 'friction' is '-1'", ">= 0"}},
      {"{pairs: [{bodies: [a, b], thickness: 0}]}", {"pairs[0]: 'thickness' is '0'", "> 0"}},
      {"{only_pairs: true}", {"only_pairs is true, but 'pairs' names none"}},
      {"{only_pairs: some, pairs: [{bodies: [a, b]}]}", {"'only_pairs' is 'some'"}},
      {"{exept: [[a, b]]}", {"unknown key 'exept' in effects.body_contact", "'except'"}}};
  for (const Refused& refused : all) {
    const std::string text =
        refusal(four(refused.effect, "obstacles: [{name: table, shape: plane}]\n"));
    for (const char* part : refused.parts) {
      EXPECT_TRUE(has(text, part)) << refused.effect << "\n" << text << "\nwithout " << part;
    }
  }
}

TEST(BodyPairs, ThoseThatAreMovedAsOneAreOne) {
  const auto scene = [&](const std::string& effect) {
    return scene_text(
        {slab("a", "patch", 0.05), slab("b", "patch", 0.15), slab("c", "rigid", 0.25)},
        "  self_contact: {}\n  body_contact: " + effect + "\n");
  };
  const std::string within = refusal(scene("{except: [[a, b]]}"));
  EXPECT_TRUE(has(within, "scene.yaml:8")) << within;
  EXPECT_TRUE(has(within, "'a' and 'b' are moved as one body, 'a+b'")) << within;
  const std::string twice = refusal(scene("{pairs: [{bodies: [a, c]}, {bodies: [b, c]}]}"));
  EXPECT_TRUE(has(twice, "'a+b' and 'c' are named already")) << twice;
  EXPECT_EQ(refusal(scene("{pairs: [{bodies: [a, c], friction: 0}]}")), "");
}

TEST(BodyPairs, ThoseThatAreLeftOutAreNotWarnedOf) {
  EXPECT_TRUE(near_of(four("{}")).empty());
  EXPECT_TRUE(near_of(four("{except: [[a, b], [c, tray]]}")).empty());
  const auto near =
      near_of(four("{only_pairs: true, pairs: [{bodies: [a, b]}], except: [[tray, c]]}"));
  // What is one body further is near too: boxes have few vertices.
  ASSERT_EQ(near.size(), 3u);
  for (const std::string& warning : near) {
    EXPECT_FALSE(has(warning, "'a' and 'b'") || has(warning, "'c' and 'tray'")) << warning;
    EXPECT_TRUE(has(warning, "'except'")) << warning;
  }
}

TEST(BodyPairs, BodiesThatDoNotTouchAreNotMovedTogether) {
  const auto world = world_of(four("{except: [[a, c], [a, tray], [b, c], [b, tray]]}"));
  EXPECT_EQ(body_named(*world, "a").group, body_named(*world, "b").group);
  EXPECT_EQ(body_named(*world, "c").group, body_named(*world, "tray").group);
  EXPECT_NE(body_named(*world, "a").group, body_named(*world, "c").group);
  EXPECT_TRUE(world->step());
  // By way of others they do.
  const auto chain =
      world_of(four("{only_pairs: true, pairs: [{bodies: [a, c]}, {bodies: [c, b]}]}"));
  EXPECT_EQ(body_named(*chain, "a").group, body_named(*chain, "b").group);
  EXPECT_NE(body_named(*chain, "a").group, body_named(*chain, "tray").group);
}

TEST(BodyPairs, SolversOfBodiesThatDoNotTouchNeedNotGoTogether) {
  const std::vector<std::string> bodies = {slab("sheet", "cloth", 0.2, "solver: {name: xpbd}"),
                                           slab("block", "patch", 0.05, "solver: {name: jacobi}")};
  EXPECT_TRUE(has(refusal(scene_text(bodies, "  body_contact: {}\n")), "cannot go together"));
  EXPECT_EQ(refusal(scene_text(bodies, "  body_contact: {except: [[sheet, block]]}\n")), "");
}

TEST(BodyPairs, ContactThatLeavesOutAllPairsIsWarnedOf) {
  const SceneFiles files;
  const std::string text = scene_text({slab("a", "rigid", 0.05), slab("b", "rigid", 0.15)},
                                      "  body_contact: {except: [[a, b]]}\n");
  const auto warnings = load_scene(files.write("scene.yaml", text)).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings[0], "not two bodies that it acts on")) << warnings[0];
}

}  // namespace
}  // namespace pliant::body_pairs_test
