// What CudaExecutor promises beyond HostExecutor: order between memory and its stream.
#include <gtest/gtest.h>

#include <vector>

#include "cuda/core/cuda_executor.cuh"
#include "cuda/skip_without_gpu.h"

namespace pliant {
namespace {

TEST(CudaExecutorOnGpu, NewMemoryIsClearedBeforeItIsFilled) {
  PLIANT_SKIP_WITHOUT_GPU();
  CudaExecutor executor;
  for (int trial = 0; trial < 300; ++trial) {
    // Large ones take long to clear; small ones are uploaded at once.
    std::vector<CudaExecutor::Array<int>> arrays(8);
    const auto large = static_cast<std::size_t>(1) << 24;
    arrays[0].resize(large);
    for (std::size_t k = 1; k < arrays.size(); ++k) {
      const std::vector<int> ones(64 * k, 1);
      arrays[k].resize(ones.size());
      executor.upload(arrays[k], ones.data(), ones.size());
    }
    for (std::size_t k = 1; k < arrays.size(); ++k) {
      std::vector<int> found(64 * k);
      executor.download(found.data(), arrays[k], found.size());
      ASSERT_EQ(found, std::vector<int>(64 * k, 1)) << "trial " << trial;
    }
  }
}

}  // namespace
}  // namespace pliant
