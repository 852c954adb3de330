#include "pliant/solvers/components.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/elements/attachment_set.h"
#include "support/random.h"
#include "support/system_model.h"

namespace pliant::components_test {
namespace {

Components components_of(SystemModel& model) {
  return find_components(static_cast<const ProjectiveSystem&>(model.system()));
}

/// Five particles on a line: springs tie 0 to 3 and 1 to 4, nothing ties 2.
std::unique_ptr<SystemModel> three_components() {
  Positions x = Positions::Zero(3, 5);
  x.row(0) = Eigen::VectorXd::LinSpaced(5, 0.0, 4.0).transpose();
  auto model = std::make_unique<SystemModel>(x);
  model->add("stretch", {{0, 3, 3.0, 10.0}, {1, 4, 3.0, 20.0}});
  return model;
}

TEST(Components, AreWhatElementsHoldTogether) {
  const auto model = three_components();
  const Components found = components_of(*model);
  EXPECT_EQ(found.of, (std::vector<int>{0, 1, 2, 0, 1}));
  EXPECT_EQ(found.members, (std::vector<int>{0, 3, 1, 4, 2}));
  EXPECT_EQ(found.begins, (std::vector<int>{0, 2, 4, 5}));
  EXPECT_EQ(found.pinned, (std::vector<bool>{false, false, false}));
  EXPECT_TRUE(found.outer_sets.empty());
  EXPECT_EQ(found.outer_stiffness.norm(), 0.0);
}

TEST(Components, EndAtPinnedParticlesAndKnowOfThem) {
  const auto model = three_components();
  model->add("bend", {{0, 1, 1.0, 5.0}});
  model->particles().fix(1);
  const Components found = components_of(*model);
  EXPECT_EQ(found.of, (std::vector<int>{0, Components::kNone, 1, 0, 2}));
  EXPECT_EQ(found.pinned, (std::vector<bool>{true, false, true}));
}

TEST(Components, AttachmentsHoldThemFromOutside) {
  const auto model = three_components();
  auto attachments = std::make_unique<AttachmentSet>(5);
  attachments->add(4, Eigen::Vector3d::Zero(), 300.0);
  model->add(std::move(attachments));
  const Components found = components_of(*model);
  EXPECT_EQ(found.outer_sets, (std::vector<std::size_t>{1}));
  EXPECT_EQ(found.outer_stiffness, Eigen::VectorXd::Unit(5, 4) * 300.0);
  EXPECT_EQ(found.pinned, (std::vector<bool>{false, false, false}));
}

TEST(Components, DoNotDependOnTheOrderOfElements) {
  Random random(4);
  std::vector<Spring> springs;
  for (int k = 0; k < 30; ++k) {
    const int a = static_cast<int>(40 * random(0.0, 1.0));
    const int b = static_cast<int>(40 * random(0.0, 1.0));
    if (a != b) springs.push_back({a, b, 1.0, 10.0});
  }
  const Positions x = random.positions(40, 1.0);
  SystemModel one(x), other(x);
  one.add("stretch", springs);
  std::reverse(springs.begin(), springs.end());
  other.add("stretch", springs);
  const Components a = components_of(one), b = components_of(other);
  EXPECT_EQ(a.of, b.of);
  EXPECT_EQ(a.members, b.members);
  EXPECT_GT(a.count(), 9);
}

}  // namespace
}  // namespace pliant::components_test
