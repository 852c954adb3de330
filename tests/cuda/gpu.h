#pragma once

#include <gtest/gtest.h>

#include <string>

namespace pliant {

/// Why this machine runs no CUDA kernel; empty where it does.
std::string why_no_gpu();

/// The GPU that kernels run on, and its driver: for messages.
std::string gpu_name();

}  // namespace pliant

/// The first statement of every test that runs a kernel.
#define PLIANT_SKIP_WITHOUT_GPU()                                          \
  do {                                                                     \
    const std::string reason = ::pliant::why_no_gpu();                     \
    if (!reason.empty()) GTEST_SKIP() << "no usable GPU here: " << reason; \
  } while (false)
