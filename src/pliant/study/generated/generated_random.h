#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace pliant {

/// The same numbers on every platform and in every run of one seed (splitmix64).
class GeneratedRandom {
 public:
  explicit GeneratedRandom(std::uint64_t seed) : state_(2 * seed + 1) {}

  /// Uniform in [lo, hi).
  double operator()(double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(next() >> 11) * 0x1.0p-53);
  }
  /// One of 0 to count - 1.
  int pick(int count) { return static_cast<int>((*this)(0.0, count)); }

  Eigen::Vector3d vector(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }
  Eigen::Matrix3d rotation() {
    const double w = (*this)(-1, 1), x = (*this)(-1, 1), y = (*this)(-1, 1);
    return Eigen::Quaterniond(w, x, y, (*this)(-1, 1)).normalized().toRotationMatrix();
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace pliant
