// nearest_rotation beside Eigen's JacobiSVD in one run: ns a rotation, and the worst angle [rad] to
// the singular value decomposition in double (of no meaning for lines). Warm starts are the given
// angle away. rotation_sweep says whether the results are right.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "pliant/math/rotation.h"
#include "pliant/math/rotation_batch.h"
#include "support/rotation_cases.h"

namespace pliant::bench {
namespace {

constexpr int kCount = 1024;

template <typename T>
struct Matrices {
  std::vector<Matrix3<T>> f;
  std::vector<Quaternion<T>> warm_starts;
  std::vector<ReferenceRotation> references;
};

/// Turned bodies with singular values s1, s2, s3; the warm starts are `angle` [rad] away.
template <typename T, typename SingularValues>
Matrices<T> make_matrices(double angle, const SingularValues& singular_values) {
  Matrices<T> set;
  Random random(1);
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Vector3d s = singular_values(random);
    set.f.push_back(plain_matrix<T>(random_frames(random, s(0), s(1), s(2))));
    set.references.push_back(reference_rotation(wide(set.f.back())));
    const Eigen::AngleAxisd turn(angle, random.vector(1).normalized());
    set.warm_starts.push_back(
        plain_quaternion<T>(turn * Eigen::Quaterniond(set.references.back().rotation)));
  }
  return set;
}

Eigen::Vector3d stretches(Random& random) { return {1, random(0.3, 1), random(0.3, 1)}; }

/// Without warm start: a stretched body, a flat one, and one flat to a line, whose spin is free.
template <typename T>
Matrices<T> cold_matrices(benchmark::State& state) {
  switch (state.range(0)) {
    case 0:
      state.SetLabel("stretched");
      return make_matrices<T>(0.0, stretches);
    case 1:
      state.SetLabel("plane");
      return make_matrices<T>(0.0, [](Random&) { return Eigen::Vector3d(1, 0.7, 0); });
    default:
      state.SetLabel("line");
      return make_matrices<T>(0.0, [](Random&) { return Eigen::Vector3d(1, 0, 0); });
  }
}

template <typename T>
void set_counters(benchmark::State& state, const Matrices<T>& set,
                  const std::vector<Quaternion<T>>& q) {
  state.counters["seconds_each"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kCount,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  double worst = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Quaterniond reference(set.references[k].rotation);
    worst = std::max(worst, 2.0 * (wide(q[k]) * reference.conjugate()).vec().norm());
  }
  state.counters["angle_error"] = worst;
}

double angle_of(const benchmark::State& state) {
  return 1e-3 * static_cast<double>(state.range(0));
}

template <typename T>
void warm(benchmark::State& state) {
  const Matrices<T> set = make_matrices<T>(angle_of(state), stretches);
  std::vector<Quaternion<T>> q(kCount);
  for (auto _ : state) {
    for (int k = 0; k < kCount; ++k) q[k] = nearest_rotation(set.f[k], set.warm_starts[k]);
    benchmark::DoNotOptimize(q.data());
    benchmark::ClobberMemory();
  }
  set_counters(state, set, q);
}

template <typename T>
void warm_batch(benchmark::State& state) {
  const Matrices<T> set = make_matrices<T>(angle_of(state), stretches);
  std::vector<Quaternion<T>> q(kCount);
  for (auto _ : state) {
    q = set.warm_starts;
    nearest_rotations(set.f.data(), q.data(), kCount);
    benchmark::ClobberMemory();
  }
  set_counters(state, set, q);
}

template <typename T>
void cold(benchmark::State& state) {
  const Matrices<T> set = cold_matrices<T>(state);
  std::vector<Quaternion<T>> q(kCount);
  for (auto _ : state) {
    for (int k = 0; k < kCount; ++k) q[k] = nearest_rotation(set.f[k]);
    benchmark::DoNotOptimize(q.data());
    benchmark::ClobberMemory();
  }
  set_counters(state, set, q);
}

template <typename T>
void cold_batch(benchmark::State& state) {
  const Matrices<T> set = cold_matrices<T>(state);
  std::vector<Quaternion<T>> q(kCount);
  for (auto _ : state) {
    nearest_rotations_cold(set.f.data(), q.data(), kCount);
    benchmark::ClobberMemory();
  }
  set_counters(state, set, q);
}

template <typename T>
void jacobi_svd(benchmark::State& state) {
  using Matrix = Eigen::Matrix<T, 3, 3>;
  const Matrices<T> set = cold_matrices<T>(state);
  std::vector<Matrix> f(kCount), r(kCount);
  for (int k = 0; k < kCount; ++k) f[k] = wide(set.f[k]).template cast<T>();
  const auto solve = [&](int k) {
    const Eigen::JacobiSVD<Matrix> svd(f[k], Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix u = svd.matrixU();
    if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) *= T(-1);
    r[k].noalias() = u * svd.matrixV().transpose();
  };
  for (auto _ : state) {
    for (int k = 0; k < kCount; ++k) solve(k);
    benchmark::DoNotOptimize(r.data());
    benchmark::ClobberMemory();
  }
  std::vector<Quaternion<T>> q;
  for (const Matrix& m : r) {
    q.push_back(plain_quaternion<T>(Eigen::Quaterniond(m.template cast<double>())));
  }
  set_counters(state, set, q);
}

void warm_angles(benchmark::internal::Benchmark* b) {
  b->ArgName("mrad")->Arg(1)->Arg(10)->Arg(100)->Arg(1000);
}
BENCHMARK_TEMPLATE(warm, float)->Apply(warm_angles);
BENCHMARK_TEMPLATE(warm_batch, float)->Apply(warm_angles);
BENCHMARK_TEMPLATE(cold, float)->DenseRange(0, 2);
BENCHMARK_TEMPLATE(cold_batch, float)->DenseRange(0, 2);
BENCHMARK_TEMPLATE(jacobi_svd, float)->DenseRange(0, 2);
BENCHMARK_TEMPLATE(warm, double)->Apply(warm_angles);
BENCHMARK_TEMPLATE(warm_batch, double)->Apply(warm_angles);
BENCHMARK_TEMPLATE(cold, double)->DenseRange(0, 2);
BENCHMARK_TEMPLATE(cold_batch, double)->DenseRange(0, 2);
BENCHMARK_TEMPLATE(jacobi_svd, double)->DenseRange(0, 2);

}  // namespace
}  // namespace pliant::bench

BENCHMARK_MAIN();
