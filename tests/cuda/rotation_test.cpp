#include "pliant/math/rotation.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "cuda/gpu_rotations.h"
#include "cuda/skip_without_gpu.h"
#include "support/rotation_cases.h"

namespace pliant {
namespace {

constexpr int kCount = 1'000'000;

template <typename T>
struct Cases {
  std::vector<Matrix3<T>> f;
  std::vector<Quaternion<T>> warm_starts;
};

template <typename T>
Cases<T> make_cases() {
  Cases<T> cases;
  Random random(11);
  for (int i = 0; i < kCount; ++i) {
    const RotationCase c = rotation_case(random, i);
    cases.f.push_back(plain_matrix<T>(c.f));
    cases.warm_starts.push_back(plain_quaternion<T>(c.warm_start));
  }
  // What no singular value decomposition takes.
  cases.f[0].m[4] = std::numeric_limits<T>::quiet_NaN();
  cases.f[1].m[8] = std::numeric_limits<T>::infinity();
  cases.f[2] = {};
  cases.warm_starts[3] = {T(0), T(0), T(0), T(0)};
  cases.warm_starts[4].x = std::numeric_limits<T>::quiet_NaN();
  return cases;
}

/// Results that differ from the CPU's in any bit.
template <typename T, typename OnCpu>
int count_differences(const std::vector<Quaternion<T>>& gpu, const OnCpu& on_cpu) {
  int count = 0;
  for (int i = 0; i < kCount; ++i) {
    const Quaternion<T> cpu = on_cpu(i);
    if (std::memcmp(&gpu[i], &cpu, sizeof(cpu)) != 0) ++count;
  }
  return count;
}

template <typename T>
void expect_best(const std::vector<Matrix3<T>>& f, const std::vector<Quaternion<T>>& gpu) {
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Matrix3d m = wide(f[i]);
    ASSERT_TRUE(wide(gpu[i]).coeffs().allFinite()) << i;
    if (!m.allFinite()) continue;
    const RotationError error = rotation_error(reference_rotation(m), gpu[i]);
    ASSERT_LT(error.length, 4.0) << i;
    ASSERT_LT(error.deficit, 24.0) << i;
    ASSERT_LT(error.angle, 32.0) << i;
  }
}

template <typename T>
class GpuRotationTest : public testing::Test {};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(GpuRotationTest, Scalars);

TYPED_TEST(GpuRotationTest, EasyAndHardMatricesGiveTheBitsOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  const Cases<TypeParam> cases = make_cases<TypeParam>();
  const auto warm = gpu_rotations(cases.f, cases.warm_starts);
  EXPECT_EQ(count_differences(
                warm, [&](int i) { return nearest_rotation(cases.f[i], cases.warm_starts[i]); }),
            0)
      << "of " << kCount << " on " << gpu_name();
  const auto cold = gpu_rotations_cold(cases.f);
  EXPECT_EQ(count_differences(cold, [&](int i) { return nearest_rotation(cases.f[i]); }), 0)
      << "of " << kCount << " on " << gpu_name();
}

TYPED_TEST(GpuRotationTest, EasyAndHardMatricesAgreeWithTheSingularValueDecomposition) {
  PLIANT_SKIP_WITHOUT_GPU();
  const Cases<TypeParam> cases = make_cases<TypeParam>();
  expect_best(cases.f, gpu_rotations(cases.f, cases.warm_starts));
  expect_best(cases.f, gpu_rotations_cold(cases.f));
}

}  // namespace
}  // namespace pliant
