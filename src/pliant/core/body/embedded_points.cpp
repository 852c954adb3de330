#include "pliant/core/body/embedded_points.h"

#include <utility>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {
constexpr int kGrain = 1024;
}

EmbeddedPoints::EmbeddedPoints(Eigen::Matrix4Xi particles, Eigen::Matrix4Xd weights)
    : particles_(std::move(particles)), weights_(std::move(weights)) {}

void EmbeddedPoints::positions(const Positions& x, Eigen::Ref<Eigen::Matrix3Xd> points) const {
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) points.col(i) = position(x, i);
  });
}

Eigen::VectorXd EmbeddedPoints::interpolate(const Eigen::VectorXd& field) const {
  Eigen::VectorXd values(size());
  for (int i = 0; i < size(); ++i) {
    values[i] = 0.0;
    for (int k = 0; k < 4; ++k) values[i] += weights_(k, i) * field[particles_(k, i)];
  }
  return values;
}

}  // namespace pliant
