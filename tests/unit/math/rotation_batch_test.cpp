#include "pliant/math/rotation_batch.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "pliant/math/rotation.h"
#include "support/rotation_cases.h"

namespace pliant {
namespace {

template <typename T>
class RotationBatchTest : public testing::Test {};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RotationBatchTest, Scalars);

template <typename T>
bool same_bits(const Quaternion<T>& a, const Quaternion<T>& b) {
  return std::memcmp(&a, &b, sizeof(a)) == 0;
}

template <typename T>
void expect_same_as_one_by_one(int count, Random& random) {
  std::vector<Matrix3<T>> f;
  std::vector<Quaternion<T>> warm_starts;
  for (int i = 0; i < count; ++i) {
    const RotationCase c = rotation_case(random, i);
    f.push_back(plain_matrix<T>(c.f));
    const double length = i % 7 == 0 ? 3.0 : 1.0;
    warm_starts.push_back(plain_quaternion<T>(Eigen::Quaterniond(c.warm_start.coeffs() * length)));
  }
  std::vector<Quaternion<T>> warm = warm_starts, cold = warm_starts;
  nearest_rotations(f.data(), warm.data(), count);
  nearest_rotations_cold(f.data(), cold.data(), count);
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(same_bits(warm[i], nearest_rotation(f[i], warm_starts[i]))) << i;
    EXPECT_TRUE(same_bits(cold[i], nearest_rotation(f[i]))) << i;
  }
}

TYPED_TEST(RotationBatchTest, GivesTheBitsOfOneByOne) {
  Random random(3);
  for (int count : {0, 1, 3, 4, 7, 15, 16, 17, 33, 20'000}) {
    expect_same_as_one_by_one<TypeParam>(count, random);
  }
}

// As a simulation calls it: most lanes succeed at once.
TYPED_TEST(RotationBatchTest, GivesTheBitsOfOneByOneNearTheWarmStart) {
  using T = TypeParam;
  Random random(4);
  std::vector<Matrix3<T>> f;
  std::vector<Quaternion<T>> warm_starts;
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Matrix3d m = random_frames(random, 1, random(0.3, 1), random(0.3, 1));
    const Eigen::AngleAxisd turn(random_magnitude(random, -5, 0), random.vector(1).normalized());
    f.push_back(plain_matrix<T>(m));
    warm_starts.push_back(
        plain_quaternion<T>(turn * Eigen::Quaterniond(reference_rotation(m).rotation)));
  }
  std::vector<Quaternion<T>> q = warm_starts;
  nearest_rotations(f.data(), q.data(), static_cast<int>(f.size()));
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_TRUE(same_bits(q[i], nearest_rotation(f[i], warm_starts[i]))) << i;
  }
}

}  // namespace
}  // namespace pliant
