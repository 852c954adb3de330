#include "support/rotation_cases.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "pliant/math/matrix3.h"
#include "support/random.h"

namespace pliant {

Eigen::Matrix3d random_entries(Random& random) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i) = random(-1, 1);
  return m;
}

Eigen::Matrix3d unscaled_rotation_case(Random& random, int kind) {
  const auto sign = [&] { return random(-1, 1) < 0 ? -1.0 : 1.0; };
  const double tiny = random_magnitude(random, -17, 0);
  switch (kind) {
    case 0:
      return random_entries(random);
    case 1:  // near identity
      return Eigen::Matrix3d::Identity() + tiny * random_entries(random);
    case 2:  // a stretched and turned body
      return random_frames(random, 1, random(0.3, 1), random(0.3, 1));
    case 3:  // any stretches, inverted or not
      return random_frames(random, 1, tiny, sign() * random_magnitude(random, -17, 0));
    case 4:  // a line with some thickness
      return random_frames(random, 1, tiny, tiny);
    case 5:  // a plane with some thickness
      return random_frames(random, 1, random(0.5, 1), sign() * tiny);
    case 6:  // reflected, the rotation about to be free, or free
      return random_frames(random, 1, 0.5, -0.5 + (random(0, 1) < 0.2 ? 0.0 : tiny));
    case 7:  // reflected, all alike
      return random_frames(random, 1, 1, -1 + (random(0, 1) < 0.2 ? 0.0 : tiny));
    case 8: {  // few different entries: zero, rank one, permutations, reflections, sums that cancel
      const Eigen::Matrix3d m = random_entries(random);
      return (m * random(0.5, 3)).array().round();
    }
    case 9: {  // rows of very different size
      Eigen::Matrix3d m = random_entries(random);
      for (int i = 0; i < 3; ++i) m.row(i) *= random_magnitude(random, -12, 0);
      return m;
    }
    case 10:  // rank one
      return random.vector(1) * random.vector(1).transpose();
    default:  // coincident singular values
      return random_frames(random, 1, 1, sign() * (random(0, 1) < 0.5 ? 1 : tiny));
  }
}

RotationCase rotation_case(Random& random, int index) {
  const double scale = random_magnitude(random, -10, 10);
  const Eigen::Matrix3d f = scale * unscaled_rotation_case(random, index % kRotationKinds);
  return {f, Eigen::Quaterniond(random.rotation())};
}

ReferenceRotation reference_rotation(const Eigen::Matrix3d& f) {
  ReferenceRotation reference;
  const double size = f.cwiseAbs().maxCoeff();
  reference.f = size > 0 ? Eigen::Matrix3d(f / size) : f;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(reference.f,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  Eigen::Vector3d sigma = (u.transpose() * reference.f * svd.matrixV()).diagonal();
  if ((u * svd.matrixV().transpose()).determinant() < 0) {
    u.col(2) *= -1;
    sigma(2) *= -1;
  }
  reference.rotation = u * svd.matrixV().transpose();
  reference.best = sigma.sum();
  reference.norm = sigma.norm();
  reference.gap = size > 0 ? (sigma(1) + sigma(2)) / reference.norm : 0.0;
  return reference;
}

}  // namespace pliant
