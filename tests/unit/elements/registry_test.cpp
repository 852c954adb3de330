#include "pliant/elements/registry.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/worlds.h"

namespace pliant {
namespace {

TEST(ElementKinds, NameEverySetOfACloth) {
  auto world = make_world(ClothScene());
  for (const auto& set : dynamic_cast<ProjectiveSystem&>(body_of(*world).model->system()).elements) {
    const auto same = [&](const ElementKind& kind) { return kind.name == set->name(); };
    EXPECT_EQ(std::count_if(element_kinds().begin(), element_kinds().end(), same), 1) << set->name();
  }
}

}  // namespace
}  // namespace pliant
