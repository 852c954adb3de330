#pragma once

#include <algorithm>
#include <vector>

#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/vector.h"

namespace pliant::bench {

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Seconds of each replay of a graph, by events.
inline std::vector<double> replay_times(CudaExecutor& executor, const CudaExecutor::Graph& graph,
                                        int count) {
  cudaEvent_t begin, end;
  check_cuda(cudaEventCreate(&begin), "event");
  check_cuda(cudaEventCreate(&end), "event");
  std::vector<double> times;
  for (int k = 0; k < count + 3; ++k) {
    check_cuda(cudaEventRecord(begin, executor.stream()), "event");
    executor.replay(graph);
    check_cuda(cudaEventRecord(end, executor.stream()), "event");
    check_cuda(cudaEventSynchronize(end), "event");
    float milliseconds = 0.0f;
    check_cuda(cudaEventElapsedTime(&milliseconds, begin, end), "event");
    if (k >= 3) times.push_back(1e-3 * milliseconds);  // the first ones warm up
  }
  cudaEventDestroy(begin);
  cudaEventDestroy(end);
  return times;
}

struct CopyFloats {
  const Float4* from;
  Float4* to;
  PLIANT_HOST_DEVICE void operator()(int i) const { to[i] = from[i]; }
};

/// Bytes a second of a copy that no cache holds, read and written.
inline double copy_bandwidth() {
  CudaExecutor executor;
  constexpr int kSize = 1 << 26;  // 1 GiB each
  CudaExecutor::Array<Float4> from, to;
  from.resize(kSize);
  to.resize(kSize);
  const auto by_kernel = executor.capture([&] {
    executor.launch(kSize, CopyFloats{from.data(), to.data()});
  });
  const auto by_engine = executor.capture([&] {
    check_cuda(cudaMemcpyAsync(to.data(), from.data(), sizeof(Float4) * kSize,
                               cudaMemcpyDeviceToDevice, executor.stream()),
               "copy");
  });
  const double best = std::min(median(replay_times(executor, by_kernel, 20)),
                               median(replay_times(executor, by_engine, 20)));
  return 2.0 * sizeof(Float4) * kSize / best;
}

}  // namespace pliant::bench
