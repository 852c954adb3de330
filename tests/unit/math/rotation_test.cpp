#include "pliant/math/rotation.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "pliant/math/shortest_turn.h"
#include "support/rotation_cases.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

template <typename T>
class RotationTest : public testing::Test {
 protected:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
  /// Of an angle, where the matrix determines it well [rad].
  static constexpr double kTolerance = 16 * kEpsilon;

  static Quaterniond solve(const Matrix3d& f, const Quaterniond& warm_start) {
    return wide(nearest_rotation(plain_matrix<T>(f), plain_quaternion<T>(warm_start)));
  }
  static Quaterniond solve(const Matrix3d& f) { return wide(nearest_rotation(plain_matrix<T>(f))); }
  static double angle(const Quaterniond& a, const Quaterniond& b) {
    return 2.0 * (a * b.conjugate()).vec().norm();
  }
  Quaterniond random_rotation() { return Quaterniond(random_.rotation()); }

  Random random_{7};
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RotationTest, Scalars);

bool same(const Quaterniond& a, const Quaterniond& b) { return a.coeffs() == b.coeffs(); }

TYPED_TEST(RotationTest, IdentityIsExact) {
  EXPECT_TRUE(same(this->solve(Matrix3d::Identity()), Quaterniond::Identity()));
  EXPECT_TRUE(same(this->solve(5.0 * Matrix3d::Identity()), Quaterniond::Identity()));
}

TYPED_TEST(RotationTest, RotationsAreTheirOwn) {
  for (int k = 0; k < 100; ++k) {
    const Quaterniond q = this->random_rotation();
    const Matrix3d f = 3.0 * q.toRotationMatrix();
    EXPECT_LT(this->angle(this->solve(f), q), this->kTolerance);
    EXPECT_LT(this->angle(this->solve(f, this->random_rotation()), q), this->kTolerance);
  }
}

TYPED_TEST(RotationTest, HalfTurnsAreTheirOwn) {
  std::vector<Vector3d> axes = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  for (int k = 0; k < 20; ++k) axes.push_back(this->random_.vector(1).normalized());
  for (const Vector3d& axis : axes) {
    const Quaterniond q(AngleAxisd(M_PI, axis));
    EXPECT_LT(this->angle(this->solve(q.toRotationMatrix()), q), this->kTolerance);
  }
}

TYPED_TEST(RotationTest, NothingIsLostNearTheIdentity) {
  const Vector3d axis = Vector3d(1, 2, 3).normalized();
  for (double size : {1e-2, 1e-4, 1e-6, 1e-8}) {
    // The stretch in the same matrix is as large as the angle.
    const Matrix3d stretch = Vector3d(1 + size, 1 - size, 1 + 0.3 * size).asDiagonal();
    const Matrix3d f = wide(plain_matrix<TypeParam>(AngleAxisd(size, axis) * stretch));
    const Quaterniond q(reference_rotation(f).rotation);
    EXPECT_LT(this->angle(this->solve(f), q), 2 * this->kEpsilon) << size;
  }
}

TYPED_TEST(RotationTest, PlanesDetermineTheRotation) {
  for (int k = 0; k < 100; ++k) {
    const Matrix3d v = this->random_.rotation();
    const Quaterniond q = this->random_rotation();
    const Matrix3d f = q.toRotationMatrix() * v * Vector3d(1, 1, 0).asDiagonal() * v.transpose();
    EXPECT_LT(this->angle(this->solve(f), q), this->kTolerance);
    EXPECT_LT(this->angle(this->solve(f, this->random_rotation()), q), this->kTolerance);
  }
}

TYPED_TEST(RotationTest, ThinLinesDetermineTheRotation) {
  for (double e : {1e-1, 1e-2, 1e-3, 1e-4, 1e-8, 1e-12}) {
    if (e < 1000 * this->kEpsilon) continue;
    for (int k = 0; k < 20; ++k) {
      const Matrix3d f = random_frames(this->random_, 1, e, e);
      const Matrix3d rounded = wide(plain_matrix<TypeParam>(f));
      const Quaterniond q(reference_rotation(rounded).rotation);
      EXPECT_LT(this->angle(this->solve(f, this->random_rotation()), q), 8 * this->kEpsilon / e);
    }
  }
}

// The nearest rotation to the warm start W that maps v to u is the shortest turn from Wv to u,
// after W.
TYPED_TEST(RotationTest, LinesKeepTheSpinOfTheWarmStart) {
  for (int k = 0; k < 200; ++k) {
    const Vector3d u = this->random_.vector(1).normalized();
    const Vector3d v = this->random_.vector(1).normalized();
    const Quaterniond warm = this->random_rotation();
    const Quaterniond q = shortest_turn(warm * v, u) * warm;
    // The turn's axis is the worse known the nearer it comes to half a turn.
    const double turn = (warm * v + u).norm();
    EXPECT_LT(this->angle(this->solve(4.0 * u * v.transpose(), warm), q), this->kTolerance / turn);
  }
}

TYPED_TEST(RotationTest, ReflectionsKeepWhatIsFreeOfTheWarmStart) {
  // Any best rotation maps the first axis to itself; the turn about it is free.
  const Matrix3d f = Vector3d(1, 0.5, -0.5).asDiagonal();
  for (double spin : {0.0, 0.3, 1.5, 3.0}) {
    const Quaterniond kept(AngleAxisd(spin, Vector3d::UnitX()));
    const Quaterniond warm = AngleAxisd(0.2, Vector3d::UnitY()) * kept;
    EXPECT_LT(this->angle(this->solve(f, kept), kept), this->kTolerance);
    EXPECT_LT(this->angle(this->solve(f, warm), kept), this->kTolerance);
  }
}

TYPED_TEST(RotationTest, ZeroKeepsTheWarmStart) {
  const Quaterniond warm = wide(plain_quaternion<TypeParam>(this->random_rotation()));
  EXPECT_TRUE(same(this->solve(Matrix3d::Zero(), warm), warm));
  EXPECT_TRUE(same(this->solve(Matrix3d::Zero()), Quaterniond::Identity()));
}

TYPED_TEST(RotationTest, NanAndInfinityKeepTheWarmStart) {
  const Quaterniond warm = wide(plain_quaternion<TypeParam>(this->random_rotation()));
  const double infinity = std::numeric_limits<double>::infinity();
  for (double bad : {std::nan(""), infinity, -infinity}) {
    for (int k = 0; k < 9; ++k) {
      Matrix3d f = random_entries(this->random_);
      f(k) = bad;
      EXPECT_TRUE(same(this->solve(f, warm), warm));
      EXPECT_TRUE(same(this->solve(f), Quaterniond::Identity()));
    }
    EXPECT_TRUE(same(this->solve(Matrix3d::Constant(bad), warm), warm));
  }
}

TYPED_TEST(RotationTest, WarmStartsHalfATurnAwayAreLeft) {
  for (int k = 0; k < 300; ++k) {
    const Quaterniond q = this->random_rotation();
    const Matrix3d v = k < 100 ? Matrix3d::Identity() : this->random_.rotation();
    const Vector3d sigma(1, 0.8, k % 2 ? 0.5 : -0.5);
    const Matrix3d f = q.toRotationMatrix() * v * sigma.asDiagonal() * v.transpose();
    // About a principal axis the objective's gradient is zero.
    const Vector3d axis = k % 4 ? Vector3d(v.col(k % 3)) : this->random_.vector(1).normalized();
    const Quaterniond warm = q * AngleAxisd(M_PI, axis);
    EXPECT_LT(this->angle(this->solve(f, warm), q), 3 * this->kTolerance);
  }
}

TYPED_TEST(RotationTest, WarmStartsNeedNotHaveUnitLength) {
  const Matrix3d f = Vector3d(1, 0.8, 0.5).asDiagonal();
  const double infinity = std::numeric_limits<double>::infinity();
  for (double scale : {1e-42, 1e-30, 1e-10, 0.9, 1.01, 3.0, 1e10, 1e30}) {
    const Quaterniond warm(0.6 * scale, 0.8 * scale, 0, 0);
    EXPECT_LT(this->angle(this->solve(f, warm), Quaterniond::Identity()), this->kTolerance);
    const Quaterniond kept = this->solve(Matrix3d::Zero(), warm);
    EXPECT_NEAR(kept.norm(), 1.0, 4 * this->kEpsilon) << scale;
    if (scale > 1e-31) {  // below, float has few digits
      EXPECT_LT(this->angle(kept, Quaterniond(0.6, 0.8, 0, 0)), this->kTolerance) << scale;
    }
  }
  for (double bad : {0.0, std::nan(""), infinity}) {
    const Quaterniond warm(0, bad, 0, bad);
    EXPECT_LT(this->angle(this->solve(f, warm), Quaterniond::Identity()), this->kTolerance);
    EXPECT_TRUE(same(this->solve(Matrix3d::Zero(), warm), Quaterniond::Identity()));
  }
}

TYPED_TEST(RotationTest, ResultIsOnTheSideOfTheWarmStart) {
  for (int i = 0; i < 1000; ++i) {
    const RotationCase c = rotation_case(this->random_, i);
    EXPECT_GE(this->solve(c.f, c.warm_start).dot(c.warm_start), -4 * this->kEpsilon);
    EXPECT_GE(this->solve(c.f).w(), 0.0);
  }
}

TYPED_TEST(RotationTest, PowersOfTwoChangeNoBit) {
  for (int i = 0; i < 1000; ++i) {
    const Matrix3d f = wide(plain_matrix<TypeParam>(random_entries(this->random_)));
    const Quaterniond warm = this->random_rotation();
    for (double scale : {0x1p-18, 0x1p-7, 0x1p13}) {
      EXPECT_TRUE(same(this->solve(scale * f), this->solve(f)));
      EXPECT_TRUE(same(this->solve(scale * f, warm), this->solve(f, warm)));
    }
  }
}

TYPED_TEST(RotationTest, ScaleDoesNotMatter) {
  const bool is_float = std::is_same_v<TypeParam, float>;
  const std::vector<double> scales =
      is_float ? std::vector<double>{1e-37, 1e-33, 1e-30, 1e-10, 1e10, 1e30, 3e38}
               : std::vector<double>{1e-307, 1e-290, 1e-150, 1e-30, 1e30, 1e150, 1e300, 1.7e308};
  for (double scale : scales) {
    for (int k = 0; k < 100; ++k) {
      const Quaterniond q = this->random_rotation();
      const Matrix3d f = scale * (q.toRotationMatrix() * Vector3d(0.5, 0.4, 0.3).asDiagonal());
      EXPECT_LT(this->angle(this->solve(f), q), 2 * this->kTolerance) << scale;
      EXPECT_LT(this->angle(this->solve(f, this->random_rotation()), q), 2 * this->kTolerance);
    }
  }
  // The smallest number there is: every digit is gone but one.
  const double least = std::numeric_limits<TypeParam>::denorm_min();
  EXPECT_TRUE(same(this->solve(least * Matrix3d::Identity()), Quaterniond::Identity()));
}

TYPED_TEST(RotationTest, TurnsWithTheMatrix) {
  for (int k = 0; k < 300; ++k) {
    const Matrix3d f =
        random_frames(this->random_, 1, this->random_(0.3, 1), this->random_(-0.2, 1));
    const Quaterniond turn = this->random_rotation(), q = this->solve(f);
    const Matrix3d turn_matrix = turn.toRotationMatrix();
    const double tolerance = 20 * this->kTolerance;
    EXPECT_LT(this->angle(this->solve(turn_matrix * f), turn * q), tolerance);
    EXPECT_LT(this->angle(this->solve(f * turn_matrix), q * turn), tolerance);
  }
}

// A line that thins out: the spin goes from the matrix's to the warm start's, never beyond either.
TYPED_TEST(RotationTest, FreedomComesGradually) {
  const Quaterniond warm(AngleAxisd(1.0, Vector3d::UnitX()));
  double last = -1.0;
  for (double e = 32 * this->kEpsilon; e > 0.1 * this->kEpsilon; e *= 0.95) {
    const double spin =
        this->angle(this->solve(Vector3d(1, e, e).asDiagonal(), warm), Quaterniond::Identity());
    // Round-off turns the matrix's own spin by about ε/e.
    EXPECT_GE(spin, last - 0.5 * this->kEpsilon / e) << e / this->kEpsilon;
    EXPECT_LT(spin - std::max(0.0, last), 0.25) << e / this->kEpsilon;
    last = spin;
  }
  EXPECT_NEAR(last, 2.0 * std::sin(0.5), 1e-3);
}

TYPED_TEST(RotationTest, HardAndEasyMatricesAgreeWithTheSingularValueDecomposition) {
  for (int i = 0; i < 50'000; ++i) {
    const RotationCase c = rotation_case(this->random_, i);
    const Matrix3<TypeParam> f = plain_matrix<TypeParam>(c.f);
    const ReferenceRotation reference = reference_rotation(wide(f));
    const auto warm_start = plain_quaternion<TypeParam>(c.warm_start);
    for (const auto& q : {nearest_rotation(f, warm_start), nearest_rotation(f)}) {
      const RotationError error = rotation_error(reference, q);
      ASSERT_TRUE(error.finite) << i;
      ASSERT_LT(error.length, 4.0) << i;
      ASSERT_LT(error.deficit, 24.0) << i;
      ASSERT_LT(error.angle, 32.0) << i;
      // The rotation that a matrix is read as, not only the quaternion.
      const Matrix3d r = wide(to_matrix(q));
      ASSERT_LT((r.transpose() * r - Matrix3d::Identity()).norm(), 16 * this->kEpsilon) << i;
      ASSERT_GT(r.determinant(), 0.9) << i;
    }
  }
}

}  // namespace
}  // namespace pliant
