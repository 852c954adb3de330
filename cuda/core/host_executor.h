#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <vector>

namespace pliant {

/// Runs device code on the CPU, one thread after the other: the same algorithms without a GPU, for
/// tests of all that is not the GPU's own. What an executor offers:
///   Array<T>             memory that kernels see
///   Staged<T>            a vector of the host that is quick to upload and download
///   upload, download     between it and the host
///   begin_download, finish_downloads
///                        beside what is launched in between, which leaves the numbers alone
///   launch(n, f)         f(i) for i in [0, n)
///   launch_blocks(blocks, threads, shared, f)
///                        f(phase, block, thread, shared) for all threads of a block, one phase
///                        after the other, with `shared` floats that a block's threads share
///   launch_persistent(iterations, blocks, threads, shared, f)
///                        the same in each iteration of one persistent kernel: f(iteration, phase,
///                        ...) where f.has(iteration, phase, shared); what a block's threads share
///                        stays. All blocks run at the same time, and each waits in an iteration
///                        for what it needs of others from the one before (mailbox.h); a host runs
///                        the iterations one after the other, each for all blocks.
///                        fits_persistent(blocks, threads, shared, f): whether that can be
///   launch_turns(blocks, threads, shared, f)
///                        f(turn, phase, block, thread, shared) as often as a block's
///                        f.goes_on(turn, block) says
///   capture(f) -> Graph, replay(graph)
///                        what f launches, as one unit
class HostExecutor {
 public:
  template <class T>
  class Array {
   public:
    void resize(std::size_t size) { values_.assign(size, T{}); }
    std::size_t size() const { return values_.size(); }
    T* data() { return values_.data(); }
    const T* data() const { return values_.data(); }

   private:
    std::vector<T> values_;
  };
  using Graph = std::function<void()>;
  template <class T>
  using Staged = std::vector<T>;

  template <class T>
  void upload(Array<T>& to, const T* from, std::size_t count) {
    std::memcpy(to.data(), from, count * sizeof(T));
  }
  template <class T>
  void download(T* to, const Array<T>& from, std::size_t count) {
    std::memcpy(to, from.data(), count * sizeof(T));
  }
  template <class F>
  void launch(int n, const F& f) {
    for (int i = 0; i < n; ++i) f(i);
  }
  template <class F>
  void launch_blocks(int blocks, int threads, int shared_floats, const F& f) {
    std::vector<float> shared(static_cast<std::size_t>(shared_floats));
    for (int block = 0; block < blocks; ++block) {
      for (int phase = 0; phase < F::kPhases; ++phase) {
        for (int thread = 0; thread < threads; ++thread) f(phase, block, thread, shared.data());
      }
    }
  }
  template <class F>
  static bool fits_persistent(int, int, int, const F&) {
    return true;
  }
  template <class F>
  void launch_persistent(int iterations, int blocks, int threads, int shared_floats, const F& f) {
    const auto each = static_cast<std::size_t>(shared_floats);
    std::vector<float> shared(each * static_cast<std::size_t>(blocks));
    for (int iteration = 0; iteration < iterations; ++iteration) {
      for (int block = 0; block < blocks; ++block) {
        float* own = shared.data() + static_cast<std::size_t>(block) * each;
        for (int phase = 0; phase < F::kPhases; ++phase) {
          if (!f.has(iteration, phase, own)) continue;
          for (int thread = 0; thread < threads; ++thread) f(iteration, phase, block, thread, own);
        }
      }
    }
  }
  template <class F>
  void launch_turns(int blocks, int threads, int shared_floats, const F& f) {
    std::vector<float> shared(static_cast<std::size_t>(shared_floats));
    for (int block = 0; block < blocks; ++block) {
      for (int turn = 0; f.goes_on(turn, block); ++turn) {
        for (int phase = 0; phase < F::kPhases; ++phase) {
          for (int thread = 0; thread < threads; ++thread) {
            f(turn, phase, block, thread, shared.data());
          }
        }
      }
    }
  }
  template <class Launches>
  Graph capture(const Launches& launches) {
    return launches;
  }
  void replay(const Graph& graph) { graph(); }
  template <class T>
  void begin_download(T* to, const Array<T>& from, std::size_t count) {
    downloads_.push_back([=, &from] { std::memcpy(to, from.data(), count * sizeof(T)); });
  }
  void finish_downloads() {
    for (const auto& download : downloads_) download();
    downloads_.clear();
  }
  void synchronize() {}

 private:
  std::vector<std::function<void()>> downloads_;  // at the last moment: nothing may change by then
};

}  // namespace pliant
