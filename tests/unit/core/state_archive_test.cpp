#include "pliant/core/state_archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant::state_archive_test {
namespace {

StateArchive archive_of(const std::vector<double>& values) {
  StateArchive archive;
  for (const double value : values) archive.write(value);
  return archive;
}

TEST(StateArchive, GivesNumbersBackInTheirOrderAndThenNone) {
  StateArchive archive = archive_of({1.5, -2.0});
  EXPECT_EQ(archive.left(), 2u);
  EXPECT_EQ(archive.read(), 1.5);
  EXPECT_EQ(archive.read(), -2.0);
  EXPECT_EQ(archive.left(), 0u);
  EXPECT_TRUE(std::isnan(archive.read()));
  archive.rewind();
  EXPECT_EQ(archive.read(), 1.5);
}

TEST(StateArchive, TakesWholeNumbersWithinTheirBounds) {
  StateArchive archive = archive_of({-1, 3, 0, 4, -2147483648.0, 2147483647.0});
  EXPECT_EQ(archive.read_whole(-1, 3), -1);
  EXPECT_EQ(archive.read_whole(-1, 3), 3);
  EXPECT_EQ(archive.read_index(5), 0);
  EXPECT_EQ(archive.read_index(5), 4);
  EXPECT_EQ(archive.read_int(), std::numeric_limits<int>::min());
  EXPECT_EQ(archive.read_int(), std::numeric_limits<int>::max());
}

TEST(StateArchive, RefusesWhatIsNoIndex) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {-1.0, 5.0, 0.5, 1e300, -1e300, kInfinity, -kInfinity, std::nan("")}) {
    EXPECT_THROW(archive_of({value}).read_index(5), InputError) << value;
  }
  EXPECT_THROW(archive_of({0.0}).read_index(0), InputError) << "there is nothing to choose from";
  EXPECT_THROW(StateArchive().read_index(5), InputError) << "nothing is left";
  EXPECT_THROW(archive_of({2147483648.0}).read_int(), InputError);
}

TEST(StateArchive, CountsNoMoreThanFollows) {
  EXPECT_EQ(archive_of({0.0}).read_count(), 0u);
  EXPECT_EQ(archive_of({2.0, 7.0, 8.0}).read_count(), 2u);
  EXPECT_THROW(archive_of({3.0, 7.0, 8.0}).read_count(), InputError);
  EXPECT_EQ(archive_of({1.0, 7.0, 8.0, 9.0}).read_count(2), 1u);
  EXPECT_THROW(archive_of({2.0, 7.0, 8.0, 9.0}).read_count(2), InputError);
  EXPECT_THROW(archive_of({-1.0, 7.0}).read_count(), InputError);
  EXPECT_THROW(StateArchive().read_count(), InputError);
}

TEST(StateArchive, ARefusalTellsWhatBelongsThere) {
  try {
    archive_of({7.5}).read_index(5);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("7.5"), std::string::npos) << text;
    EXPECT_NE(text.find("from 0 to 4"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace pliant::state_archive_test
