// Which corners of which elements each particle is.
#include "pliant/elements/entries_of_particles.h"

#include <gtest/gtest.h>

namespace pliant::entries_of_particles_test {
namespace {

using List = std::vector<int>;

TEST(EntriesOfParticles, EachParticleHasItsCornersInTheOrderOfTheElements) {
  const EntriesOfParticles of({7, 2, 4, /**/ 2, 1, 4, /**/ 4, 9, 2}, 3);
  EXPECT_EQ(of.particles, (List{1, 2, 4, 7, 9}));
  EXPECT_EQ(of.begins, (List{0, 1, 4, 7, 8, 9}));
  EXPECT_EQ(of.entries, (List{4, /**/ 1, 3, 8, /**/ 2, 5, 6, /**/ 0, /**/ 7}));
}

TEST(EntriesOfParticles, ElementsAreOrderedByTheirParticles) {
  EXPECT_EQ(EntriesOfParticles({9, 8, /**/ 0, 3, /**/ 4, 1, /**/ 2, 1}, 2).order,
            (List{1, 3, 2, 0}));
}

TEST(EntriesOfParticles, OfNothingThereIsNone) {
  const EntriesOfParticles of({}, 4);
  EXPECT_TRUE(of.particles.empty());
  EXPECT_TRUE(of.order.empty());
  EXPECT_EQ(of.begins, List{0});
}

}  // namespace
}  // namespace pliant::entries_of_particles_test
