#pragma once

#include <gtest/gtest.h>

#include <string>

#include "cuda/core/device.h"

/// The first statement of every test that runs a kernel.
#define PLIANT_SKIP_WITHOUT_GPU()                                          \
  do {                                                                     \
    const std::string reason = ::pliant::why_no_gpu();                     \
    if (!reason.empty()) GTEST_SKIP() << "no usable GPU here: " << reason; \
  } while (false)
