#pragma once

#include <vector>

#include "pliant/math/matrix3.h"

namespace pliant {

/// nearest_rotation(f[i], warm_starts[i]) by the GPU, one thread a matrix; T is float or double.
/// Throws std::runtime_error where CUDA fails.
template <typename T>
std::vector<Quaternion<T>> gpu_rotations(const std::vector<Matrix3<T>>& f,
                                         const std::vector<Quaternion<T>>& warm_starts);

/// nearest_rotation(f[i]) by the GPU.
template <typename T>
std::vector<Quaternion<T>> gpu_rotations_cold(const std::vector<Matrix3<T>>& f);

}  // namespace pliant
