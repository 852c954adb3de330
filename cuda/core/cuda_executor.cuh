#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pliant/solvers/device/backend.h"

namespace pliant {

/// Throws DeviceFailure with CUDA's own message.
inline void check_cuda(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  (void)cudaGetLastError();
  throw DeviceFailure(std::string(what) + ": " + cudaGetErrorString(error));
}

namespace cuda_detail {

template <class F>
__global__ void run_each(const __grid_constant__ F f, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) f(i);
}

template <class F>
__device__ __forceinline__ void run_phases(const F& f, float* shared) {
  const int block = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
#pragma unroll
  for (int phase = 0; phase < F::kPhases; ++phase) {
    if (phase > 0) __syncthreads();
    f(phase, block, thread, shared);
  }
}

template <class F>
__global__ void run_blocks(const __grid_constant__ F f) {
  extern __shared__ float shared[];
  run_phases(f, shared);
}

/// With so few registers a thread that kLeastBlocks of kMostThreads run on a multiprocessor.
template <class F>
__global__ void __launch_bounds__(F::kMostThreads, F::kLeastBlocks)
    run_many_blocks(const __grid_constant__ F f) {
  extern __shared__ float shared[];
  run_phases(f, shared);
}

template <class F, class = void>
constexpr bool kHasBounds = false;
template <class F>
constexpr bool kHasBounds<F, std::void_t<decltype(F::kLeastBlocks)>> = true;

template <class F>
__global__ void __launch_bounds__(F::kMostThreads)
    run_persistent(const __grid_constant__ F f, int iterations) {
  extern __shared__ float shared[];
  const int block = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
  for (int iteration = 0; iteration < iterations; ++iteration) {
#pragma unroll
    for (int phase = 0; phase < F::kPhases; ++phase) {
      if (!f.has(iteration, phase, shared)) continue;
      __syncthreads();
      f(iteration, phase, block, thread, shared);
    }
  }
}

template <class F>
__global__ void run_turns(const __grid_constant__ F f) {
  extern __shared__ float shared[];
  const int block = static_cast<int>(blockIdx.x);
  for (int turn = 0; f.goes_on(turn, block); ++turn) {
    // Nobody changes what says so before all have read it.
    __syncthreads();
    for (int phase = 0; phase < F::kPhases; ++phase) {
      f(turn, phase, block, static_cast<int>(threadIdx.x), shared);
      __syncthreads();
    }
  }
}

/// Memory of the host that stays where it is, which the GPU reads and writes by itself.
template <class T>
struct PinnedAllocator {
  using value_type = T;
  PinnedAllocator() = default;
  template <class U>
  PinnedAllocator(const PinnedAllocator<U>&) {}
  T* allocate(std::size_t count) {
    void* memory = nullptr;
    check_cuda(cudaMallocHost(&memory, count * sizeof(T)), "memory for transfers to the GPU");
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { cudaFreeHost(memory); }
  template <class U>
  bool operator==(const PinnedAllocator<U>&) const {
    return true;
  }
  template <class U>
  bool operator!=(const PinnedAllocator<U>&) const {
    return false;
  }
};

}  // namespace cuda_detail

/// Runs device code on the GPU, in a stream of its own. See HostExecutor for what an executor
/// offers. Throws DeviceFailure.
class CudaExecutor {
 public:
  template <class T>
  class Array {
   public:
    Array() = default;
    ~Array() { cudaFree(data_); }
    Array(Array&& other) noexcept { *this = std::move(other); }
    Array& operator=(Array&& other) noexcept {
      std::swap(data_, other.data_);
      std::swap(size_, other.size_);
      return *this;
    }
    void resize(std::size_t size) {
      cudaFree(std::exchange(data_, nullptr));
      size_ = 0;
      if (size == 0) return;
      check_cuda(cudaMalloc(&data_, size * sizeof(T)), "memory for a body on the GPU");
      size_ = size;
      // Streams of executors wait for no other: what is uploaded next must not be cleared later.
      check_cuda(cudaMemset(data_, 0, size * sizeof(T)), "memory for a body on the GPU");
      check_cuda(cudaStreamSynchronize(cudaStreamLegacy), "memory for a body on the GPU");
    }
    std::size_t size() const { return size_; }
    T* data() { return data_; }
    const T* data() const { return data_; }

   private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
  };

  template <class T>
  using Staged = std::vector<T, cuda_detail::PinnedAllocator<T>>;

  /// What was captured, ready to run again.
  class Graph {
   public:
    Graph() = default;
    explicit Graph(cudaGraphExec_t graph) : graph_(graph) {}
    ~Graph() {
      if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
    }
    Graph(Graph&& other) noexcept : graph_(std::exchange(other.graph_, nullptr)) {}
    Graph& operator=(Graph&& other) noexcept {
      std::swap(graph_, other.graph_);
      return *this;
    }
    explicit operator bool() const { return graph_ != nullptr; }
    cudaGraphExec_t get() const { return graph_; }

   private:
    cudaGraphExec_t graph_ = nullptr;
  };

  CudaExecutor() {
    check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "stream on the GPU");
  }
  ~CudaExecutor() {
    if (ready_ != nullptr) cudaEventDestroy(ready_);
    if (copies_ != nullptr) cudaStreamDestroy(copies_);
    cudaStreamDestroy(stream_);
  }
  CudaExecutor(const CudaExecutor&) = delete;
  CudaExecutor& operator=(const CudaExecutor&) = delete;

  cudaStream_t stream() const { return stream_; }

  template <class T>
  void upload(Array<T>& to, const T* from, std::size_t count) {
    check_cuda(cudaMemcpyAsync(to.data(), from, count * sizeof(T), cudaMemcpyHostToDevice, stream_),
               "upload to the GPU");
  }
  /// The numbers are there on return.
  template <class T>
  void download(T* to, const Array<T>& from, std::size_t count) {
    check_cuda(cudaMemcpyAsync(to, from.data(), count * sizeof(T), cudaMemcpyDeviceToHost, stream_),
               "download from the GPU");
    synchronize();
  }
  /// Of numbers that are there once what was launched so far is done, to Staged memory; what is
  /// launched later runs beside it.
  template <class T>
  void begin_download(T* to, const Array<T>& from, std::size_t count) {
    if (copies_ == nullptr) {
      check_cuda(cudaStreamCreateWithFlags(&copies_, cudaStreamNonBlocking), "stream on the GPU");
      check_cuda(cudaEventCreateWithFlags(&ready_, cudaEventDisableTiming), "event on the GPU");
    }
    check_cuda(cudaEventRecord(ready_, stream_), "event on the GPU");
    check_cuda(cudaStreamWaitEvent(copies_, ready_, 0), "event on the GPU");
    check_cuda(cudaMemcpyAsync(to, from.data(), count * sizeof(T), cudaMemcpyDeviceToHost, copies_),
               "download from the GPU");
  }
  void finish_downloads() {
    if (copies_ != nullptr) check_cuda(cudaStreamSynchronize(copies_), "download from the GPU");
  }
  template <class F>
  void launch(int n, const F& f) {
    if (n == 0) return;
    constexpr int kThreads = 128;
    cuda_detail::
        run_each<<<static_cast<unsigned>((n + kThreads - 1) / kThreads), kThreads, 0, stream_>>>(f,
                                                                                                 n);
    check_cuda(cudaGetLastError(), "kernel on the GPU");
  }
  template <class F>
  void launch_blocks(int blocks, int threads, int shared_floats, const F& f) {
    if (blocks == 0) return;
    const std::size_t bytes = static_cast<std::size_t>(shared_floats) * sizeof(float);
    const dim3 grid(static_cast<unsigned>(blocks)), each(static_cast<unsigned>(threads));
    if constexpr (cuda_detail::kHasBounds<F>) {
      allow_shared<cuda_detail::run_many_blocks<F>>(bytes);
      cuda_detail::run_many_blocks<<<grid, each, bytes, stream_>>>(f);
    } else {
      allow_shared<cuda_detail::run_blocks<F>>(bytes);
      cuda_detail::run_blocks<<<grid, each, bytes, stream_>>>(f);
    }
    check_cuda(cudaGetLastError(), "kernel on the GPU");
  }
  /// Whether all blocks run at the same time.
  template <class F>
  bool fits_persistent(int blocks, int threads, int shared_floats, const F&) {
    const std::size_t bytes = static_cast<std::size_t>(shared_floats) * sizeof(float);
    allow_shared<cuda_detail::run_persistent<F>>(bytes);
    int device = 0, processors = 0, each = 0;
    check_cuda(cudaGetDevice(&device), "GPU");
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "GPU");
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, cuda_detail::run_persistent<F>,
                                                             threads, bytes),
               "kernel on the GPU");
    return blocks > 0 && blocks <= each * processors;
  }
  template <class F>
  void launch_persistent(int iterations, int blocks, int threads, int shared_floats, const F& f) {
    const std::size_t bytes = static_cast<std::size_t>(shared_floats) * sizeof(float);
    allow_shared<cuda_detail::run_persistent<F>>(bytes);
    void* arguments[] = {const_cast<F*>(&f), &iterations};
    check_cuda(cudaLaunchCooperativeKernel(
                   cuda_detail::run_persistent<F>, dim3(static_cast<unsigned>(blocks)),
                   dim3(static_cast<unsigned>(threads)), arguments, bytes, stream_),
               "kernel on the GPU");
  }
  template <class F>
  void launch_turns(int blocks, int threads, int shared_floats, const F& f) {
    if (blocks == 0) return;
    const std::size_t bytes = static_cast<std::size_t>(shared_floats) * sizeof(float);
    allow_shared<cuda_detail::run_turns<F>>(bytes);
    cuda_detail::run_turns<<<static_cast<unsigned>(blocks), static_cast<unsigned>(threads), bytes,
                             stream_>>>(f);
    check_cuda(cudaGetLastError(), "kernel on the GPU");
  }
  void synchronize() { check_cuda(cudaStreamSynchronize(stream_), "work on the GPU"); }

  /// What `launches` launches, without running it.
  template <class Launches>
  Graph capture(const Launches& launches) {
    check_cuda(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "graph");
    cudaGraph_t graph = nullptr;
    try {
      launches();
    } catch (...) {
      cudaStreamEndCapture(stream_, &graph);
      if (graph != nullptr) cudaGraphDestroy(graph);
      throw;
    }
    check_cuda(cudaStreamEndCapture(stream_, &graph), "graph");
    cudaGraphExec_t ready = nullptr;
    const cudaError_t error = cudaGraphInstantiate(&ready, graph, 0);
    cudaGraphDestroy(graph);
    check_cuda(error, "graph");
    return Graph(ready);
  }
  void replay(const Graph& graph) {
    check_cuda(cudaGraphLaunch(graph.get(), stream_), "graph on the GPU");
  }

 private:
  template <auto* kKernel>
  static void allow_shared(std::size_t bytes) {
    static std::size_t allowed = 48 * 1024;
    if (bytes <= allowed) return;
    check_cuda(cudaFuncSetAttribute(kKernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(bytes)),
               "shared memory on the GPU");
    allowed = bytes;
  }

  cudaStream_t stream_ = nullptr;
  cudaStream_t copies_ = nullptr;  // null: there was no download beside launches yet
  cudaEvent_t ready_ = nullptr;
};

}  // namespace pliant
