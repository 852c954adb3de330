#include <cuda_runtime.h>

#include "cuda/core/device.h"

namespace pliant {
namespace {

__global__ void nothing() {}

}  // namespace

std::string why_no_gpu() {
  int count = 0;
  cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess) return cudaGetErrorString(error);
  if (count == 0) return "the driver finds none";
  // The binary holds code for some architectures only.
  nothing<<<1, 1>>>();
  error = cudaDeviceSynchronize();
  return error == cudaSuccess ? "" : cudaGetErrorString(error);
}

std::string gpu_name() {
  cudaDeviceProp properties{};
  if (cudaGetDeviceProperties(&properties, 0) != cudaSuccess) return "unknown";
  return properties.name;
}

}  // namespace pliant
