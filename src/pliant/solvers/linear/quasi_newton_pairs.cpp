#include "pliant/solvers/linear/quasi_newton_pairs.h"

#include <algorithm>

#include "pliant/solvers/linear/vector_products.h"

namespace pliant {
namespace {
// Pairs with less curvature than this, relative to their lengths, say nothing of the Hessian.
constexpr double kLeastCurvature = 1e-12;
}  // namespace

double QuasiNewtonPairs::dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return dot_product(a.size(), a.data(), b.data());
}

void QuasiNewtonPairs::add(double scale, const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& a) {
  add_product(a.size(), scale, b.data(), a.data());
}

void QuasiNewtonPairs::clear() {
  held_ = 0;
  next_ = 0;
}

void QuasiNewtonPairs::add_next() {
  Pair& pair = next();
  const int capacity = static_cast<int>(pairs_.size());
  const double curvature = dot(pair.s, pair.y);
  pair.z.resize(3, 0);
  if (curvature > kLeastCurvature * pair.s.norm() * pair.y.norm()) {
    pair.inverse = 1.0 / curvature;
    next_ = (next_ + 1) % capacity;
    held_ = std::min(held_ + 1, capacity);
  } else {
    held_ = std::min(held_, capacity - 1);  // it took the place of the oldest one
  }
}

}  // namespace pliant
