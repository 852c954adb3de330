#include "pliant/geometry/mesh/polygon.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <numeric>

namespace pliant {
namespace {

using Eigen::Vector3d;

// Ear clipping.
class Polygon {
 public:
  explicit Polygon(const std::vector<Vector3d>& corners)
      : corners_(corners), left_(corners.size()), normal_(Vector3d::Zero()) {
    std::iota(left_.begin(), left_.end(), 0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      normal_ += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    }
    const double length = normal_.stableNorm();
    if (length > 0.0) normal_ /= length;
    rounding_ = 1e-12 * length;
  }

  std::size_t size() const { return left_.size(); }

  std::array<int, 3> clip() {
    const std::size_t ear = find_ear();
    const std::array<int, 3> triangle = corner(ear);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
    return triangle;
  }

 private:
  std::array<int, 3> corner(std::size_t i) const {
    const std::size_t n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  // Twice the area of a, b, c as seen against the polygon's normal.
  double turn(int a, int b, int c) const {
    return (corners_[b] - corners_[a]).cross(corners_[c] - corners_[a]).dot(normal_);
  }

  std::size_t find_ear() const {
    std::size_t sharpest = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left_.size(); ++i) {
      const auto [a, b, c] = corner(i);
      const double size = turn(a, b, c);
      if (size > rounding_ && is_empty(a, b, c)) return i;
      if (size > most) {
        most = size;
        sharpest = i;
      }
    }
    return sharpest;
  }

  // A corner on the ear's border counts as within: cutting along it would leave overlaps.
  bool is_empty(int a, int b, int c) const {
    for (const int p : left_) {
      const Vector3d& at = corners_[p];
      if (at == corners_[a] || at == corners_[b] || at == corners_[c]) continue;
      if (turn(a, b, p) >= -rounding_ && turn(b, c, p) >= -rounding_ &&
          turn(c, a, p) >= -rounding_) {
        return false;
      }
    }
    return true;
  }

  const std::vector<Vector3d>& corners_;
  std::vector<int> left_;
  Vector3d normal_;
  double rounding_;
};

}  // namespace

std::vector<std::array<int, 3>> triangulate_polygon(const std::vector<Vector3d>& corners) {
  std::vector<std::array<int, 3>> triangles;
  if (corners.size() < 3) return triangles;
  if (corners.size() == 3) return {{0, 1, 2}};
  Polygon polygon(corners);
  while (polygon.size() >= 3) triangles.push_back(polygon.clip());
  return triangles;
}

}  // namespace pliant
