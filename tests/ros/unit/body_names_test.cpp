#include "pliant/ros/body_names.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/ros/interactive/nearest_body.h"
#include "pliant/ros/markers/body_colors.h"
#include "pliant/scene/scene.h"

namespace pliant {
namespace {

LoadedScene together() { return load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/together.yaml"); }

/// Of the two bodies of a scene.
BodyNames names_of(const std::string& first, const std::string& second) {
  LoadedScene scene = together();
  scene.world->bodies()[0].name = first;
  scene.world->bodies()[1].name = second;
  return BodyNames(scene.world->bodies());
}

std::string refusal(const BodyNames& names, const std::string& name) {
  try {
    names.find("attach", name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(GraphName, HasOnlyWhatRosAllows) {
  EXPECT_EQ(graph_name_of("towel_2"), "towel_2");
  EXPECT_EQ(graph_name_of("a+b"), "a_b");
  EXPECT_EQ(graph_name_of("W\xc3\xbcrfel 1/2"), "W_rfel_1_2") << "one for each letter";
  EXPECT_EQ(graph_name_of("2nd"), "body_2nd");
  EXPECT_EQ(graph_name_of("_x"), "body__x");
  EXPECT_EQ(graph_name_of("\xe6\x9d\xb1"), "body__");
  EXPECT_EQ(graph_name_of(""), "body_");
}

TEST(BodyNames, NamesThatMeetAreNumbered) {
  const BodyNames names = names_of("soft ball", "soft_ball");
  EXPECT_EQ(names.graph_name(1), "soft_ball") << "a valid name stays";
  EXPECT_EQ(names.graph_name(0), "soft_ball_2");
  ASSERT_EQ(names.replaced().size(), 1u);
  EXPECT_NE(names.replaced()[0].find("'soft ball'"), std::string::npos);
  EXPECT_NE(names.replaced()[0].find("'soft_ball_2'"), std::string::npos);
  EXPECT_TRUE(names_of("a", "b").replaced().empty());
  LoadedScene scene = load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/hanging.yaml");
  scene.world->bodies().front().name = "a+b";
  EXPECT_TRUE(BodyNames(scene.world->bodies()).replaced().empty()) << "it has no topics of its own";
}

TEST(BodyNames, AreFoundByEitherName) {
  const BodyNames names = names_of("soft ball", "soft_ball");
  EXPECT_EQ(names.find("x", "soft ball"), std::vector<std::size_t>{0});
  EXPECT_EQ(names.find("x", "soft_ball_2"), std::vector<std::size_t>{0});
  EXPECT_EQ(names.find("x", "soft_ball"), std::vector<std::size_t>{1}) << "the scene's name first";
  EXPECT_EQ(names.find("x", ""), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(names.text({0}), "'soft ball'");
  EXPECT_EQ(names.text({0, 1}), "all 2 bodies");
}

TEST(BodyNames, RefuseOthersWithTheNearest) {
  EXPECT_EQ(refusal(names_of("towel", "ball"), "towl"),
            "attach: unknown body 'towl': allowed are towel, ball; did you mean 'towel'?");
  EXPECT_EQ(refusal(names_of("towel+rag", "ball"), "rag"),
            "attach: body 'rag' is moved as one with others that it may touch: name 'towel+rag'");
}

TEST(NearestBody, IsThatOfTheNearestVertex) {
  const LoadedScene scene = together();
  const std::deque<Body>& bodies = scene.world->bodies();
  EXPECT_EQ(nearest_body(bodies, {0.0, 0.0, 0.1}).body, 0u);
  EXPECT_NEAR(nearest_body(bodies, {0.06, 0.06, 0.3}).distance, 0.2, 1e-9) << "a corner below";
  EXPECT_EQ(nearest_body(bodies, {0.0, 0.0, 0.0}).body, 1u);
}

TEST(BodyColors, DifferWhereTheSceneLeavesThemOpen) {
  LoadedScene scene = together();
  const Eigen::Vector3f first = scene.world->bodies()[0].model->color;
  color_apart(scene);
  EXPECT_EQ(scene.world->bodies()[0].model->color, first);
  EXPECT_GT((scene.world->bodies()[1].model->color - first).norm(), 0.3f);
  scene.spec.bodies[1].color = scene.world->bodies()[1].model->color = Eigen::Vector3f::Zero();
  color_apart(scene);
  EXPECT_EQ(scene.world->bodies()[1].model->color, Eigen::Vector3f::Zero().eval());
}

TEST(GraphNames, OfLinksDiffer) {
  EXPECT_EQ(graph_names_of({"palm", "7th finger", "pal-m", "pal m", "palm"}, "link_"),
            (std::vector<std::string>{"palm", "link_7th_finger", "pal_m", "pal_m_2", "palm_2"}));
  EXPECT_TRUE(graph_names_of({}, "link_").empty());
}

}  // namespace
}  // namespace pliant
