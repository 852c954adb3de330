#pragma once

#include <cmath>

#include "pliant/math/host_device.h"

namespace pliant {

/// Six equations in double precision, alike on CPU and GPU.
struct Matrix6 {
  double m[36];

  PLIANT_HOST_DEVICE double operator()(int i, int j) const { return m[6 * i + j]; }
  PLIANT_HOST_DEVICE double& operator()(int i, int j) { return m[6 * i + j]; }
};

/// Solves `a` x = `b`, which becomes x, with the largest pivot of each column. 0 along what no
/// equation tells, as the turn of particles on a line about it.
PLIANT_HOST_DEVICE inline void solve(Matrix6 a, double* b) {
  constexpr double kNothing = 1e-13;
  double largest = 0.0;
  for (double value : a.m) largest = std::fabs(value) > largest ? std::fabs(value) : largest;
  for (int c = 0; c < 6; ++c) {
    int pivot = c;
    for (int r = c + 1; r < 6; ++r) {
      if (std::fabs(a(r, c)) > std::fabs(a(pivot, c))) pivot = r;
    }
    for (int k = 0; k < 6; ++k) {
      const double kept = a(c, k);
      a(c, k) = a(pivot, k);
      a(pivot, k) = kept;
    }
    const double kept = b[c];
    b[c] = b[pivot];
    b[pivot] = kept;
    if (!(std::fabs(a(c, c)) > kNothing * largest)) {
      for (int k = 0; k < 6; ++k) a(c, k) = k == c ? 1.0 : 0.0;
      b[c] = 0.0;
    }
    for (int r = c + 1; r < 6; ++r) {
      const double factor = a(r, c) / a(c, c);
      for (int k = c; k < 6; ++k) a(r, k) -= factor * a(c, k);
      b[r] -= factor * b[c];
    }
  }
  for (int c = 5; c >= 0; --c) {
    for (int k = c + 1; k < 6; ++k) b[c] -= a(c, k) * b[k];
    b[c] /= a(c, c);
  }
}

}  // namespace pliant
