#include "pliant/study/experiments/reduced_parts.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "pliant/math/error.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

class ReducedPartsFolder : public testing::Test {
 protected:
  std::string part(const ReducedParts& parts, const std::string& text) {
    return parts.part("a_1", [&] {
      ++made_;
      return text;
    });
  }
  SceneFiles files_;
  std::string folder_ = files_.path("study");
  int made_ = 0;
};

TEST_F(ReducedPartsFolder, MakesAPartOnce) {
  EXPECT_EQ(part(ReducedParts(folder_, "x 1"), "rows\n"), "rows\n");
  const ReducedParts again(folder_, "x 1");
  EXPECT_FALSE(again.started_afresh());
  EXPECT_EQ(part(again, "others\n"), "rows\n");
  EXPECT_EQ(made_, 1);
}

TEST_F(ReducedPartsFolder, BelongsToOneAtATime) {
  const std::string me = std::to_string(getpid());
  {
    const ReducedParts first(folder_, "x 1");
    expect_refusal([&] { ReducedParts(folder_, "x 2"); },
                   {folder_, "another one is at work there (process " + me + ")", "--out"});
  }
  EXPECT_FALSE(ReducedParts(folder_, "x 1").started_afresh());
}

TEST_F(ReducedPartsFolder, KeepsNothingOfAPartThatWasStopped) {
  const ReducedParts parts(folder_, "x 1");
  EXPECT_EQ(part(parts, ""), "");
  EXPECT_EQ(part(parts, "rows\n"), "rows\n");
  EXPECT_EQ(made_, 2);
}

TEST_F(ReducedPartsFolder, StartsAfreshWithOtherSettings) {
  part(ReducedParts(folder_, "x 1"), "rows\n");
  {
    const ReducedParts other(folder_, "x 2");
    EXPECT_TRUE(other.started_afresh());
    EXPECT_EQ(part(other, "others\n"), "others\n");
  }
  EXPECT_FALSE(ReducedParts(folder_, "x 2").started_afresh());
}

TEST_F(ReducedPartsFolder, KeepsAnyBytes) {
  const std::string bytes("\0\n\xff\r\n", 5);
  part(ReducedParts(folder_, "x"), bytes);
  EXPECT_EQ(part(ReducedParts(folder_, "x"), "no"), bytes);
}

TEST_F(ReducedPartsFolder, CanBeRemoved) {
  const ReducedParts parts(folder_, "x");
  part(parts, "rows\n");
  parts.remove();
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/parts"));
}

TEST_F(ReducedPartsFolder, RefusesAFolderThatCannotBeMade) {
  EXPECT_THROW(ReducedParts("/proc/none", "x"), InputError);
}

}  // namespace
}  // namespace pliant
