#include "pliant/solvers/device/cuda_library.h"

namespace pliant {

LoadedLibrary& cuda_library() {
  static LoadedLibrary library("libpliant_cuda.so");
  return library;
}

std::string why_no_cuda_library() {
  return "this build has no CUDA (" + cuda_library().why_not() +
         "): install NVIDIA's toolkit and configure with -DPLIANT_CUDA=ON";
}

std::string why_no_cuda() {
  auto* tell_why_no_gpu = cuda_library().find<TellWhyNoGpu>(kTellWhyNoGpu);
  if (tell_why_no_gpu == nullptr) return why_no_cuda_library();
  std::string reason;
  tell_why_no_gpu(reason);
  return reason;
}

std::unique_ptr<SolverBatch> make_cuda_batch() {
  std::unique_ptr<SolverBatch> batch;
  cuda_function<MakeCudaBatch>(kMakeCudaBatch)(batch);
  return batch;
}

}  // namespace pliant
