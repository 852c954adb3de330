#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "pliant/core/body/particles.h"

namespace pliant {

/// The same numbers on every platform and in every run of one seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}

  /// Uniform in [lo, hi).
  double operator()(double lo, double hi) {
    // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    z ^= z >> 31;
    return lo + (hi - lo) * (static_cast<double>(z >> 11) * 0x1.0p-53);
  }

  Eigen::Vector3d vector(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }

  Positions positions(int count, double size) {
    Positions x(3, count);
    for (int i = 0; i < count; ++i) x.col(i) = vector(size);
    return x;
  }

  Eigen::Matrix3d rotation() {
    Eigen::Quaterniond q((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
    return q.normalized().toRotationMatrix();
  }

 private:
  std::uint64_t state_;
};

}  // namespace pliant
