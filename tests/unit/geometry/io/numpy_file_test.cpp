#include "pliant/geometry/io/numpy_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "pliant/math/error.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

TEST(NumpyFile, IsReadByNumpy) {
  const SceneFiles files;
  const std::string path = files.path("a.npy");
  write_npy(path, {2, 1, 3}, {1, 2, 3, -4.5, 1e300, 0.1});
  EXPECT_EQ((contents(path).size() - 6 * sizeof(double)) % 64, 0u);
  const std::string row = files.path("row.npy");
  write_npy(row, {2}, {7, 8});
  const Outcome outcome =
      run_command("/usr/bin/python3 -c \"import numpy\nfor file in '" + path + "', '" + row +
                  "': a = numpy.load(file); print(a.shape, a.dtype, a.tolist())\"");
  EXPECT_EQ(outcome.text,
            "(2, 1, 3) float64 [[[1.0, 2.0, 3.0]], [[-4.5, 1e+300, 0.1]]]\n"
            "(2,) float64 [7.0, 8.0]\n");
}

TEST(NumpyFile, OfNothingHoldsNothing) {
  const SceneFiles files;
  const std::string path = files.path("a.npy");
  write_npy(path, {0, 3}, {});
  EXPECT_EQ(contents(path).size() % 64, 0u);
}

TEST(NumpyFile, SaysWhereItCannotWrite) {
  EXPECT_THROW(write_npy("/no/such/folder/a.npy", {1}, {1.0}), InputError);
}

}  // namespace
}  // namespace pliant
