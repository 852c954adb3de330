// What CudaExecutor promises beyond HostExecutor: order between memory and its stream.
#include <gtest/gtest.h>

#include <vector>

#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/host_executor.h"
#include "cuda/core/mailbox.h"
#include "cuda/core/vector.h"
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

/// Each block takes the sum of what its two neighbours had in the last iteration of the kernel.
struct SumOfNeighbors {
  static constexpr int kPhases = 2, kMostThreads = 64;
  Fixed* x[2];
  int blocks;

  PLIANT_HOST_DEVICE static bool has(int, int, float*) { return true; }
  PLIANT_HOST_DEVICE void operator()(int iteration, int phase, int block, int thread,
                                     float* shared) const {
    if (phase == 0 && thread < 2) {
      const int other = thread == 0 ? block + 1 : block + blocks - 1;
      const Fixed* from = x[iteration % 2] + other % blocks;
      reinterpret_cast<Fixed*>(shared)[thread] = await(from, iteration);
    }
    if (phase == 1 && thread == 0) {
      const auto* neighbors = reinterpret_cast<const Fixed*>(shared);
      const int sum = neighbors[0].x + neighbors[1].x + iteration;
      post(x[1 - iteration % 2] + block, {sum % 1000003, -sum, 2 * sum, 0.0f}, iteration + 1);
    }
  }
};

/// The next launch begins with the numbers that the last one left.
struct BeginSums {
  Fixed* x[2];

  PLIANT_HOST_DEVICE void operator()(int i) const {
    x[0][i].w = version_bits(0);
    x[1][i] = {0, 0, 0, version_bits(0)};
  }
};

template <class Executor>
std::vector<int> sums_of_neighbors(int blocks, int iterations, int launches, bool& is_taken) {
  Executor executor;
  const auto size = static_cast<std::size_t>(blocks);
  typename Executor::template Array<Fixed> first, second;
  first.resize(size);
  second.resize(size);
  std::vector<Fixed> values(size);
  for (int b = 0; b < blocks; ++b) values[static_cast<std::size_t>(b)] = {b, 0, 0, 0.0f};
  executor.upload(first, values.data(), size);
  const SumOfNeighbors sums = {{first.data(), second.data()}, blocks};
  is_taken = executor.fits_persistent(blocks, 64, 8, sums);
  if (!is_taken) return {};
  const auto graph = executor.capture([&] {
    executor.launch(blocks, BeginSums{{first.data(), second.data()}});
    executor.launch_persistent(iterations, blocks, 64, 8, sums);
  });
  for (int k = 0; k < launches; ++k) executor.replay(graph);
  executor.download(values.data(), first, size);
  std::vector<int> result;
  for (const Fixed& value : values) {
    result.push_back(value.x);
    result.push_back(value.y);
    result.push_back(value.z);
  }
  return result;
}

TEST(CudaExecutorOnGpu, BlocksOfAnIterationReadWhatOthersPostedInTheLastOne) {
  PLIANT_SKIP_WITHOUT_GPU();
  for (int blocks : {1, 2, 97, 500}) {
    bool is_taken = false;
    const auto found = sums_of_neighbors<CudaExecutor>(blocks, 8, 200, is_taken);
    ASSERT_TRUE(is_taken);
    EXPECT_EQ(found, sums_of_neighbors<HostExecutor>(blocks, 8, 200, is_taken)) << blocks;
  }
}

TEST(CudaExecutorOnGpu, LaunchesNoPersistentKernelWhereBlocksWouldWaitForOnesThatHaveNotBegun) {
  PLIANT_SKIP_WITHOUT_GPU();
  bool is_taken = true;
  sums_of_neighbors<CudaExecutor>(1 << 20, 8, 1, is_taken);
  EXPECT_FALSE(is_taken);
}

}  // namespace
}  // namespace pliant
