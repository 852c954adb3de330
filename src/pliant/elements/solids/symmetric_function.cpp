#include "pliant/elements/solids/symmetric_function.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {
// Share of the spread below which two eigenvalues are taken together: more than the √ε by which
// they are off, and small enough that its square is round-off.
constexpr double kClose = 1e-7;
}  // namespace

Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& s) {
  // S = m I + p B with tr B = 0 and |B|² = 6: det B / 2 is the cosine of three times an angle.
  const double m = s.trace() / 3.0;
  Eigen::Matrix3d b = s;
  b.diagonal().array() -= m;
  const double p = std::sqrt(b.squaredNorm() / 6.0);
  if (!(p > 0.0)) return Eigen::Vector3d::Constant(m);
  b /= p;
  const double angle = std::acos(std::clamp(0.5 * b.determinant(), -1.0, 1.0)) / 3.0;
  constexpr double kThirdOfATurn = 2.0943951023931954923;
  const double largest = m + 2.0 * p * std::cos(angle);
  const double least = m + 2.0 * p * std::cos(angle + kThirdOfATurn);
  return {largest, 3.0 * m - largest - least, least};
}

Eigen::Matrix3d symmetric_function(const Eigen::Matrix3d& s, const Eigen::Vector3d& lambda,
                                   const Eigen::Vector3d& h, const Eigen::Vector3d& slope) {
  const double up = lambda[0] - lambda[1], down = lambda[1] - lambda[2];
  // The two that lie closer together, and the third.
  const int near = up < down ? 0 : 1, far = up < down ? 2 : 0;
  const double gap = std::min(up, down), spread = up + down;
  double a = lambda[near], b = lambda[near + 1], value = h[near], rise;
  if (gap > kClose * spread) {
    rise = (h[near] - h[near + 1]) / gap;
  } else {
    a = b = 0.5 * (a + b);
    value = 0.5 * (h[near] + h[near + 1]);
    rise = 0.5 * (slope[near] + slope[near + 1]);
  }
  // f[a, b, c] with c - a and c - b both of the size of the spread.
  double curvature = 0.0;
  const double between = lambda[far] - a;
  if (spread > 0.0) curvature = ((h[far] - value) / between - rise) / (lambda[far] - b);
  Eigen::Matrix3d from_a = s, from_b = s;
  from_a.diagonal().array() -= a;
  from_b.diagonal().array() -= b;
  Eigen::Matrix3d result = rise * from_a + curvature * (from_a * from_b);
  result.diagonal().array() += value;
  return result;
}

}  // namespace pliant
