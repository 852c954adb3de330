#include <cuda_runtime.h>

#include <stdexcept>

#include "cuda/gpu_rotations.h"
#include "pliant/math/rotation.h"

namespace pliant {
namespace {

void check(cudaError_t error) {
  if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}

template <typename T>
class DeviceArray {
 public:
  explicit DeviceArray(std::size_t size) : size_(size) {
    check(cudaMalloc(&data_, size * sizeof(T)));
  }
  explicit DeviceArray(const std::vector<T>& host) : DeviceArray(host.size()) {
    check(cudaMemcpy(data_, host.data(), size_ * sizeof(T), cudaMemcpyHostToDevice));
  }
  ~DeviceArray() { cudaFree(data_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  T* data() { return data_; }
  std::vector<T> to_host() const {
    std::vector<T> host(size_);
    check(cudaMemcpy(host.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost));
    return host;
  }

 private:
  T* data_ = nullptr;
  std::size_t size_;
};

constexpr int kThreads = 128;

unsigned blocks_for(std::size_t count) {
  return static_cast<unsigned>((count + kThreads - 1) / kThreads);
}

template <typename T>
__global__ void rotate(const Matrix3<T>* f, Quaternion<T>* q, std::size_t count) {
  const std::size_t i = std::size_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) q[i] = nearest_rotation(f[i], q[i]);
}

template <typename T>
__global__ void rotate_cold(const Matrix3<T>* f, Quaternion<T>* q, std::size_t count) {
  const std::size_t i = std::size_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) q[i] = nearest_rotation(f[i]);
}

}  // namespace

template <typename T>
std::vector<Quaternion<T>> gpu_rotations(const std::vector<Matrix3<T>>& f,
                                         const std::vector<Quaternion<T>>& warm_starts) {
  DeviceArray<Matrix3<T>> matrices(f);
  DeviceArray<Quaternion<T>> q(warm_starts);
  rotate<<<blocks_for(f.size()), kThreads>>>(matrices.data(), q.data(), f.size());
  check(cudaGetLastError());
  return q.to_host();
}

template <typename T>
std::vector<Quaternion<T>> gpu_rotations_cold(const std::vector<Matrix3<T>>& f) {
  DeviceArray<Matrix3<T>> matrices(f);
  DeviceArray<Quaternion<T>> q(f.size());
  rotate_cold<<<blocks_for(f.size()), kThreads>>>(matrices.data(), q.data(), f.size());
  check(cudaGetLastError());
  return q.to_host();
}

#define PLIANT_INSTANTIATE(T)                                                           \
  template std::vector<Quaternion<T>> gpu_rotations(const std::vector<Matrix3<T>>&,     \
                                                    const std::vector<Quaternion<T>>&); \
  template std::vector<Quaternion<T>> gpu_rotations_cold(const std::vector<Matrix3<T>>&);
PLIANT_INSTANTIATE(float)
PLIANT_INSTANTIATE(double)

}  // namespace pliant
