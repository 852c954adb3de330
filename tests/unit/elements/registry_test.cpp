#include "pliant/elements/registry.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/solvers/projective_model.h"
#include "support/worlds/worlds.h"
#include "unit/elements/element_examples.h"

namespace pliant {
namespace {

void expect_registered(const ElementSet& set) {
  const auto same = [&](const ElementKind& kind) { return kind.name == set.name(); };
  EXPECT_EQ(std::count_if(element_kinds().begin(), element_kinds().end(), same), 1) << set.name();
}

TEST(ElementKinds, NameEverySetOfACloth) {
  auto world = make_world(ClothScene());
  for (const auto& set : projective_system(*body_of(*world).model).elements) {
    expect_registered(*set);
  }
}

TEST(ElementKinds, NameEverySetOfBodies) {
  expect_registered(*make_example<TriangleStrainSet>(2).set);
  expect_registered(*make_example<TetrahedronSet>(2).set);
  expect_registered(*make_example<VolumeSet>(2).set);
  expect_registered(*make_example<StrainLimitSet>(2).set);
  expect_registered(*make_example<FiberSet>(2).set);
  expect_registered(*make_example<ClusterSet>(2).set);
  expect_registered(*make_example<OrientedClusterSet>(2).set);
  expect_registered(*make_example<AttachmentSet>(2).set);
}

}  // namespace
}  // namespace pliant
