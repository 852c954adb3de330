#include "pliant/study/experiments/carried_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Blend = CarriedMesh::Blend;

/// Carriers on a lattice in and about a ball of radius 1.
Eigen::Matrix3Xd lattice_carriers() {
  Eigen::Matrix3Xd carriers(3, 125);
  for (int i = 0; i < 125; ++i) {
    carriers.col(i) = 0.5 * Eigen::Vector3d(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
  }
  return carriers;
}

TEST(CarriedMesh, MovesRigidlyWithItsCarriersByEveryBlend) {
  const TriangleMesh ball = Sphere(1.0).surface();
  const Eigen::Matrix3Xd carriers = lattice_carriers();
  const CarriedMesh mesh(ball, carriers);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()));
  const Eigen::Vector3d shift(0.3, -0.2, 5.0);
  const Eigen::Matrix3Xd x = (turn.toRotationMatrix() * carriers).colwise() + shift;
  Eigen::Matrix4Xd turns = turn.coeffs().replicate(1, carriers.cols());
  // The same turn has two quaternions.
  for (Eigen::Index k = 0; k < turns.cols(); k += 2) turns.col(k) *= -1.0;
  const Eigen::Matrix3Xd exact = (turn.toRotationMatrix() * ball.vertices).colwise() + shift;
  for (const Blend blend : {Blend::kNearest, Blend::kLinear, Blend::kExponential}) {
    const Eigen::Matrix3Xd carried = mesh.carry(x, turns, blend);
    EXPECT_LT((carried - exact).colwise().norm().maxCoeff(), 1e-12);
    EXPECT_LT(rms_angle_change(ball, carried), 1e-6);
  }
}

TEST(CarriedMesh, OnlyMeansOfTurnsCarryATwistSmoothly) {
  const TriangleMesh ball = Sphere(1.0).surface();
  const Eigen::Matrix3Xd carriers = lattice_carriers();
  const auto twist = [](const Eigen::Vector3d& at) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(0.8 * at.z(), Eigen::Vector3d::UnitZ()));
  };
  Eigen::Matrix3Xd x = carriers;
  Eigen::Matrix4Xd turns(4, carriers.cols());
  for (Eigen::Index i = 0; i < carriers.cols(); ++i) {
    x.col(i) = twist(carriers.col(i)) * carriers.col(i);
    turns.col(i) = twist(carriers.col(i)).coeffs();
  }
  const CarriedMesh mesh(ball, carriers);
  const Eigen::Matrix3Xd jumping = mesh.carry(x, turns, Blend::kNearest);
  const Eigen::Matrix3Xd linear = mesh.carry(x, turns, Blend::kLinear);
  const Eigen::Matrix3Xd exponential = mesh.carry(x, turns, Blend::kExponential);
  EXPECT_GT(rms_angle_change(ball, jumping), 3.0 * rms_angle_change(ball, linear));
  EXPECT_LT((linear - exponential).colwise().norm().maxCoeff(), 1e-3);
  EXPECT_GT((linear - exponential).colwise().norm().maxCoeff(), 0.0);
}

TEST(CarriedMesh, RefusesTooFewCarriers) {
  const TriangleMesh ball = Sphere(1.0).surface();
  EXPECT_THROW(CarriedMesh(ball, Eigen::Matrix3Xd::Random(3, 8)), InputError);
  EXPECT_NO_THROW(CarriedMesh(ball, Eigen::Matrix3Xd::Random(3, 9)));
}

}  // namespace
}  // namespace pliant
