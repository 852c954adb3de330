#include "pliant/models/reduced/stretch_watch.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pliant {
namespace {

Eigen::Matrix3d sides(const Eigen::Matrix4Xi& tetrahedra, int t, const Positions& x) {
  Eigen::Matrix3d d;
  for (int k = 0; k < 3; ++k) d.col(k) = x.col(tetrahedra(k + 1, t)) - x.col(tetrahedra(0, t));
  return d;
}

}  // namespace

StretchWatch::StretchWatch(const TetrahedralMesh& rest) : tetrahedra_(rest.tetrahedra) {
  inverses_.resize(3, 3 * tetrahedra_.cols());
  for (int t = 0; t < size(); ++t) {
    inverses_.middleCols<3>(3 * t) = sides(tetrahedra_, t, rest.vertices).inverse();
  }
  reset();
}

void StretchWatch::reset() {
  smallest_.setConstant(std::numeric_limits<double>::infinity());
  next_ = 0;
}

Eigen::Matrix3d StretchWatch::gradient(int tetrahedron, const Positions& x) const {
  return sides(tetrahedra_, tetrahedron, x) * inverses_.middleCols<3>(3 * tetrahedron);
}

double StretchWatch::look(const Positions& x) {
  const auto place = [&](int part) {
    return static_cast<int>(static_cast<std::int64_t>(size()) * part / kRound);
  };
  double least = std::numeric_limits<double>::infinity();  // of the squares
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  for (int t = place(next_); t < place(next_ + 1); ++t) {
    const Eigen::Matrix3d f = gradient(t, x);
    eigen.computeDirect(f.transpose() * f, Eigen::EigenvaluesOnly);
    least = std::min(least, eigen.eigenvalues()[0]);
  }
  smallest_[next_] = std::sqrt(std::max(0.0, least));
  next_ = (next_ + 1) % kRound;
  return smallest_.minCoeff();
}

}  // namespace pliant
