#pragma once

#include <string>

namespace pliant {

/// Why this machine runs no CUDA kernel; empty where it does.
std::string why_no_gpu();

/// The GPU that kernels run on: for messages.
std::string gpu_name();

}  // namespace pliant
