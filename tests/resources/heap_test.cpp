#include "resources/heap.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <vector>

namespace pliant {
namespace {

TEST(HeapWatch, SeesEveryWayToAllocate) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  int allocations = 0;
  std::size_t in_use = 0;
  const HeapWatch watch;
  {
    Eigen::VectorXd by_eigen(100);
    auto by_new = std::make_unique<std::vector<int>>(100);
    // volatile, since compilers leave out what is only freed.
    void* volatile aligned = std::aligned_alloc(64, 1024);
    std::free(aligned);
    void* volatile cleared = std::calloc(4, 16);
    std::free(cleared);
    allocations = watch.allocations();
    in_use = watch.in_use();
  }
  const std::size_t peak = watch.peak();
  EXPECT_EQ(allocations, 5);
  // Vectors of 800, 24 and 400 bytes at once; 1024 bytes, which are gone when 64 come.
  EXPECT_GE(in_use, 800u + 24 + 400);
  EXPECT_GE(peak, in_use + 1024);
  EXPECT_LT(peak, in_use + 1024 + 200);
}

TEST(HeapWatch, PeakIsNotTheSum) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const HeapWatch watch;
  for (int k = 0; k < 100; ++k) Eigen::VectorXd(1000).setZero();
  const std::size_t peak = watch.peak();
  EXPECT_EQ(watch.allocations(), 100);
  EXPECT_GE(peak, 8000u);
  EXPECT_LT(peak, 9000u);
}

}  // namespace
}  // namespace pliant
