// How much smaller than errors residuals have to be: of stiff solids that nothing holds, alone and
// among others.
#include "pliant/solvers/checks/residual_share.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/solvers/iterations/step_objective.h"
#include "support/worlds/body_pairs.h"

namespace pliant::residual_share_test {
namespace {

double share_of(const std::vector<std::string>& bodies, double dt = 0.01) {
  std::vector<std::string> lines;
  for (const std::string& body : bodies) lines.push_back("  - {" + body + "}\n");
  const auto world = world_of(scene_text(lines, "  gravity: {}\n  body_contact: {}\n"));
  const auto& system = *world->bodies().front().group->system().as_projective();
  StepObjective objective;
  objective.prepare(system, dt);
  return share_of_free_solids(system, objective.diagonal(), objective.inertia());
}

std::string block(const std::string& young, const std::string& more = "") {
  return "name: block" + young +
         ", model: patch, geometry: {block: {size: [0.1, 0.1, 0.1], cells: "
         "[2, 2, 2]}}, material: {young: " +
         young + ", density: 500}" + more;
}
const std::string kCloth =
    "name: cloth, model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [3, 3]}}, position: "
    "[0, 0, 0.2]";

TEST(ResidualShare, IsOneOfWhatIsSoftOrHeldOrNoSolid) {
  EXPECT_EQ(share_of({block("1e3")}), 1.0);
  EXPECT_EQ(share_of({kCloth}), 1.0);
  EXPECT_EQ(share_of({block("1e7", ", fixed: [{vertices: [0]}]")}), 1.0);
  EXPECT_EQ(share_of({"name: box, model: rigid, geometry: {box: {size: [0.1, 0.1, 0.1]}}"}), 1.0);
}

// By κ^-3/4, κ in proportion to E h².
TEST(ResidualShare, FallsWithStiffnessAndTimeStep) {
  const double stiff = share_of({block("1e6")});
  EXPECT_LT(stiff, 0.2);
  EXPECT_NEAR(share_of({block("1e8")}) / stiff, std::pow(100.0, -0.75), 1e-3);
  EXPECT_NEAR(share_of({block("1e6")}, 0.1) / stiff, std::pow(100.0, -0.75), 1e-3);
}

TEST(ResidualShare, IsThatOfTheStiffestOfSeveral) {
  EXPECT_DOUBLE_EQ(share_of({block("1e4"), block("1e8", ", position: [0, 0, 0.3]"), kCloth}),
                   share_of({block("1e8")}));
}

}  // namespace
}  // namespace pliant::residual_share_test
