#include "pliant/math/error.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

const std::vector<std::string> kSolvers = {"jacobi", "verlet", "xpbd"};

TEST(InputError, CarriesItsMessage) {
  const InputError error("mass is -1 kg");
  EXPECT_STREQ(error.what(), "mass is -1 kg");
}

TEST(NearestName, FindsSlipsOfThePen) {
  EXPECT_EQ(nearest_name("xpdb", kSolvers), "xpbd");
  EXPECT_EQ(nearest_name("jacoby", kSolvers), "jacobi");
  EXPECT_EQ(nearest_name("verlett", kSolvers), "verlet");
  EXPECT_EQ(nearest_name("verle", kSolvers), "verlet");
  EXPECT_EQ(nearest_name("Verlet", kSolvers), "verlet");
  EXPECT_EQ(nearest_name("xpbd", kSolvers), "xpbd");
}

TEST(NearestName, IsEmptyWhenNothingIsNear) {
  EXPECT_EQ(nearest_name("multigrid", kSolvers), "");
  EXPECT_EQ(nearest_name("", kSolvers), "");
  EXPECT_EQ(nearest_name("xpbd", {}), "");
  EXPECT_EQ(nearest_name("q", {"a", "b"}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), kSolvers), "");
}

TEST(NearestName, PrefersTheFirstOfEquals) {
  EXPECT_EQ(nearest_name("wind1", {"wind2", "wind3"}), "wind2");
}

TEST(UnknownNameMessage, NamesAllAndTheNearest) {
  EXPECT_EQ(unknown_name_message("solver", "xpdb", kSolvers),
            "unknown solver 'xpdb': allowed are jacobi, verlet, xpbd; did you mean 'xpbd'?");
  EXPECT_EQ(unknown_name_message("solver", "multigrid", kSolvers),
            "unknown solver 'multigrid': allowed are jacobi, verlet, xpbd");
  EXPECT_EQ(unknown_name_message("key", "mas", {"mass"}),
            "unknown key 'mas': allowed is mass; did you mean 'mass'?");
  EXPECT_EQ(unknown_name_message("key", "mass", {}), "unknown key 'mass': none is allowed");
}

}  // namespace
}  // namespace pliant
