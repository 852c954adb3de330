// Contact that nobody sees coming when a step begins, since only the forces of the step bring it
// about: bodies that fall together, of which the lower one lands; a box that another one pushes
// onto the table. It ends as where a wide margin has all contacts found at once.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/measures.h"
#include "support/rms_distance.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::late_contact_test {
namespace {

constexpr double kTravel = 0.005;  // of all in a step [m]

std::string block(int number, const std::string& young, double bottom, double speed) {
  return fmt::format(
      "  - {{name: block_{}, model: patch, geometry: {{block: {{size: [0.1, 0.08, 0.04], cells: "
      "[4, 3, 2]}}}}, material: {{young: {}, density: 500}}, position: [0, 0, {}], velocity: [0, "
      "0, {}]}}\n",
      number, young, bottom + 0.02, -speed);
}

std::string effects(const char* margin) {
  return fmt::format(
      "  contact: {{thickness: 0.002, margin: {}}}\n  friction: {{coefficient: 0.5}}\n"
      "  body_contact: {{thickness: 0.002, margin: {}, friction: 0.4}}\n",
      margin, margin);
}

/// After a step.
std::unique_ptr<World> stepped(const std::vector<std::string>& bodies, const std::string& solver,
                               const char* margin) {
  auto world = world_of(
      scene_text(bodies, effects(margin),
                 "obstacles: [{name: table, shape: plane}]\nsolver: {name: " + solver + "}\n"));
  EXPECT_TRUE(world->step()) << world->failure();
  return world;
}

/// How far their bodies are from each other, as a share of the travel in a step.
double difference(const World& a, const World& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.bodies().size(); ++k) {
    const Particles& p = a.bodies()[k].particles();
    most = std::max(most, rms_distance(p, p.x, b.bodies()[k].particles().x));
  }
  return most / kTravel;
}

/// Each 1 mm farther from the next than contact needs, so that no margin but a wide one sees them.
std::vector<std::string> falling_stack(int count, const std::string& young) {
  std::vector<std::string> bodies;
  for (int k = 0; k < count; ++k) bodies.push_back(block(k, young, 0.002 + 0.043 * k, 1.0));
  return bodies;
}

std::vector<std::string> pushed_onto_the_table(const std::string& young) {
  return {block(0, young, 0.002, 0.0), block(1, young, 0.045, 1.0)};
}

class LateContact : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Young, LateContact, testing::Values("1.0e+4", "1.0e+6", "1.0e+8"));

TEST_P(LateContact, OfBodiesThatFallTogetherIsAnsweredInTheStep) {
  const auto bodies = falling_stack(3, GetParam());
  const auto world = stepped(bodies, "newton", "0.0005"), seen = stepped(bodies, "newton", "0.02");
  EXPECT_GT(body_of(*world).report.contacts, 0);
  // Contact that is found where bodies deform touches at other points of them.
  EXPECT_LT(difference(*world, *seen), 2e-3);
}

TEST_P(LateContact, OfABodyThatIsPushedOntoTheTableIsAnsweredInTheStep) {
  const auto bodies = pushed_onto_the_table(GetParam());
  const auto world = stepped(bodies, "newton", "0.0005"), seen = stepped(bodies, "newton", "0.02");
  EXPECT_LT(difference(*world, *seen), 1e-6);
}

class LateContactOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solvers, LateContactOf,
                         testing::Values("xpbd", "jacobi", "line_search_jacobi", "gauss_seidel",
                                         "hybrid", "chebyshev", "direct", "lbfgs"));

TEST_P(LateContactOf, IsAnsweredInTheStepByEverySolver) {
  const std::string solver = std::string(GetParam()) + ", iterations: 500";
  for (const auto& bodies : {falling_stack(2, "1.0e+5"), pushed_onto_the_table("1.0e+5")}) {
    const auto world = stepped(bodies, solver, "0.0005"), seen = stepped(bodies, solver, "0.02");
    EXPECT_LT(difference(*world, *seen), 0.01);
  }
}

}  // namespace
}  // namespace pliant::late_contact_test
