#include "pliant/geometry/mesh/dihedral_angles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

TetrahedralMesh one(const Eigen::Matrix<double, 3, 4>& vertices) {
  return {vertices, Eigen::Vector4i(0, 1, 2, 3)};
}

TEST(DihedralAngles, OfARegularTetrahedron) {
  Eigen::Matrix<double, 3, 4> v;
  v << 1, -1, -1, 1,  //
      1, -1, 1, -1,   //
      1, 1, -1, -1;
  TetrahedralMesh mesh = one(v);
  fix_winding(mesh);
  const double expected = std::acos(1.0 / 3.0) * 180.0 / 3.14159265358979323846;
  const AngleRange angles = dihedral_angles(mesh);
  EXPECT_NEAR(angles.least, expected, 1e-12);
  EXPECT_NEAR(angles.greatest, expected, 1e-12);
}

TEST(DihedralAngles, OfACornerOfACube) {
  Eigen::Matrix<double, 3, 4> v;
  v << 0, 1, 0, 0,  //
      0, 0, 1, 0,   //
      0, 0, 0, 1;
  const AngleRange angles = dihedral_angles(one(v));
  EXPECT_NEAR(angles.least, std::acos(1.0 / std::sqrt(3.0)) * 180.0 / 3.14159265358979323846,
              1e-12);
  EXPECT_NEAR(angles.greatest, 90.0, 1e-12);
}

TEST(DihedralAngles, OfAFlatTetrahedron) {
  Eigen::Matrix<double, 3, 4> v;
  v << 0, 1, 1, 0,  //
      0, 0, 1, 1,   //
      0, 0, 0, 0;
  const AngleRange angles = dihedral_angles(one(v));
  EXPECT_EQ(angles.least, 0.0);
  EXPECT_EQ(angles.greatest, 180.0);
}

}  // namespace
}  // namespace pliant
