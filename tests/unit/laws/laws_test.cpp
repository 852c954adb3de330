// Each law with the vectors of Eigen, with plain ones of double and of single precision, and in a
// loop over the lanes of vector registers: one formula, whose numbers differ by round-off alone.
#include <gtest/gtest.h>

#include <random>

#include "pliant/laws/corotated.h"
#include "pliant/laws/coulomb.h"
#include "pliant/laws/fiber.h"
#include "pliant/laws/membrane.h"
#include "pliant/laws/shapes.h"
#include "pliant/laws/sph_pairs.h"
#include "pliant/laws/sph_walls.h"
#include "pliant/laws/spring.h"
#include "pliant/math/rotation_eigen.h"
#include "pliant/math/vector_traits_eigen.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kCount = 512;
constexpr double kDouble = 1e-14, kSingle = 2e-6;  // of what is compared

class Laws : public testing::Test {
 protected:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// Of numbers that single precision has too.
  Eigen::Vector3d vector(double reach) {
    Eigen::Vector3d v;
    for (double& x : v) x = static_cast<double>(static_cast<float>(number(-reach, reach)));
    return v;
  }
  Eigen::Matrix3d gradient() {
    Eigen::Matrix3d g;
    g << vector(1.0), vector(1.0), vector(1.0);
    return g;
  }

 private:
  std::mt19937 random_{3};
};

template <typename T>
Vector3<T> plain(const Eigen::Vector3d& v) {
  return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}
template <typename T>
Matrix3<T> plain(const Eigen::Matrix3d& a) {
  Matrix3<T> result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result(i, j) = static_cast<T>(a(i, j));
  }
  return result;
}
template <typename T>
Eigen::Vector3d in_double(const Vector3<T>& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// Whether two vectors are the same but for round-off of `scale`.
void expect_alike(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double error, double scale) {
  EXPECT_LE((a - b).norm(), error * scale) << a.transpose() << " and " << b.transpose();
}

template <typename T>
MembraneConstants<T> fabric() {
  return {T(100), T(80), T(20), T(1000), T(0.9), T(1.05), T(0), T(1.02)};
}

TEST_F(Laws, MembranesAreAlike) {
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Vector3d a = vector(1.5), b = vector(1.5);
    const auto exact = membrane_stress(a, b, fabric<double>());
    const auto twin = membrane_stress(plain<double>(a), plain<double>(b), fabric<double>());
    const auto single = membrane_stress(plain<float>(a), plain<float>(b), fabric<float>());
    const double scale = 1e3 * (1.0 + a.norm() + b.norm());
    expect_alike(in_double(twin.along_warp), exact.along_warp, kDouble, scale);
    expect_alike(in_double(twin.along_weft), exact.along_weft, kDouble, scale);
    expect_alike(in_double(single.along_warp), exact.along_warp, kSingle, scale);
    expect_alike(in_double(single.along_weft), exact.along_weft, kSingle, scale);
  }
}

TEST_F(Laws, AMembraneStressIsTheSlopeOfItsEnergy) {
  // E = 1/2 k (|a| - 1)² and so on, beyond the limit of the weft.
  const Eigen::Vector3d a(1.02, 0.1, 0.0), b(0.05, 1.2, 0.03);
  const auto m = fabric<double>();
  const auto energy = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    const auto square = [](double x) { return x * x; };
    const auto beyond = [&](double l, double min, double max) {
      return square(l - std::min(std::max(l, min), max));
    };
    const double shear = std::sqrt(0.5) * ((p + q).norm() - (p - q).norm());
    return 0.5 * (m.warp * square(p.norm() - 1.0) + m.weft * square(q.norm() - 1.0) +
                  m.limit * (beyond(p.norm(), m.warp_min, m.warp_max) +
                             beyond(q.norm(), m.weft_min, m.weft_max)) +
                  m.shear * square(shear));
  };
  const auto stress = membrane_stress(a, b, m);
  constexpr double kStep = 1e-6;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(c);
    EXPECT_NEAR(stress.along_warp[c], (energy(a + h, b) - energy(a - h, b)) / (2.0 * kStep), 1e-5);
    EXPECT_NEAR(stress.along_weft[c], (energy(a, b + h) - energy(a, b - h)) / (2.0 * kStep), 1e-5);
  }
}

TEST_F(Laws, FibersAreAlike) {
  for (int k = 0; k < kCount; ++k) {
    // One in eight is pressed to a point, one in sixty-four with what lies across it.
    const Eigen::Vector3d g0 = k % 8 == 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : vector(2.0);
    const Eigen::Vector3d g1 = vector(2.0);
    const Eigen::Vector3d g2 = k % 64 == 0 ? g1 : vector(2.0);
    const Eigen::Vector3d exact = fiber_stress(g0, g1, g2);
    expect_alike(in_double(fiber_stress(plain<double>(g0), plain<double>(g1), plain<double>(g2))),
                 exact, kDouble, 4.0);
    expect_alike(in_double(fiber_stress(plain<float>(g0), plain<float>(g1), plain<float>(g2))),
                 exact, kSingle, 4.0);
  }
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_EQ(fiber_direction(none, none, none), Eigen::Vector3d::UnitX());
}

TEST_F(Laws, CorotatedStressesAreAlike) {
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Matrix3d g = gradient();
    const Eigen::Matrix3d r = nearest_rotation(g).toRotationMatrix();
    const double ratio = 1.5;
    const Eigen::Matrix3d strain = g - r;
    const double trace = r.cwiseProduct(strain).sum();
    const Eigen::Matrix3d exact = 2.0 * strain + ratio * trace * r;
    const Matrix3<double> twin = corotated_stress(plain<double>(g), plain<double>(r), ratio);
    const Matrix3<float> single = corotated_stress(plain<float>(g), plain<float>(r), 1.5f);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(twin(i, j), exact(i, j), kDouble * 10.0);
        EXPECT_NEAR(static_cast<double>(single(i, j)), exact(i, j), kSingle * 10.0);
      }
    }
    EXPECT_NEAR(corotated_energy(plain<double>(g), plain<double>(r), ratio),
                strain.squaredNorm() + 0.5 * ratio * trace * trace, kDouble * 50.0);
  }
}

/// The same with a number in each lane of a vector register.
PLIANT_WIDEST void stresses_in_lanes(const double (&g)[9][kCount], const double (&r)[9][kCount],
                                     double (&p)[9][kCount]) {
  for (int l = 0; l < kCount; ++l) {
    Matrix3<double> a, b;
    for (int k = 0; k < 9; ++k) {
      a.m[k] = g[k][l];
      b.m[k] = r[k][l];
    }
    const Matrix3<double> stress = corotated_stress(a, b, 1.5);
    for (int k = 0; k < 9; ++k) p[k][l] = stress.m[k];
  }
}

TEST_F(Laws, StressesInLanesHaveTheSameBits) {
  static double g[9][kCount], r[9][kCount], p[9][kCount];
  for (int l = 0; l < kCount; ++l) {
    const Eigen::Matrix3d any = gradient();
    const Matrix3<double> a = plain<double>(any);
    const Matrix3<double> b = plain<double>(nearest_rotation(any).toRotationMatrix().eval());
    for (int k = 0; k < 9; ++k) {
      g[k][l] = a.m[k];
      r[k][l] = b.m[k];
    }
  }
  stresses_in_lanes(g, r, p);
  for (int l = 0; l < kCount; ++l) {
    Matrix3<double> a, b;
    for (int k = 0; k < 9; ++k) {
      a.m[k] = g[k][l];
      b.m[k] = r[k][l];
    }
    const Matrix3<double> alone = corotated_stress(a, b, 1.5);
    for (int k = 0; k < 9; ++k) EXPECT_EQ(p[k][l], alone.m[k]);
  }
}

PLIANT_WIDEST void pulls_in_lanes(const SphKernels<double>& kernels, const double (&r)[kCount],
                                  double (&pull)[kCount], double (&drag)[kCount]) {
  for (int l = 0; l < kCount; ++l) {
    pull[l] = sph_pull(kernels, 0.3, 2.0, r[l]);
    drag[l] = sph_drag(kernels, 0.3, 2.0, r[l]);
  }
}

TEST_F(Laws, PairsOfLiquidAreAlikeInLanesAndInSinglePrecision) {
  static double r[kCount], pull[kCount], drag[kCount];
  for (double& distance : r) distance = static_cast<double>(static_cast<float>(number(0.05, 1.2)));
  r[0] = 0.0;
  const SphKernels<double> kernels(1.0);
  const SphKernels<float> single(1.0f);
  pulls_in_lanes(kernels, r, pull, drag);
  for (int l = 0; l < kCount; ++l) {
    const auto distance = static_cast<float>(r[l]);
    EXPECT_EQ(pull[l], sph_pull(kernels, 0.3, 2.0, r[l]));
    EXPECT_EQ(drag[l], sph_drag(kernels, 0.3, 2.0, r[l]));
    EXPECT_LE(pull[l], 0.0) << "pressure pulls";
    EXPECT_NEAR(sph_pull(single, 0.3f, 2.0f, distance), pull[l], 1e-5 * (1.0 + std::abs(pull[l])));
    EXPECT_NEAR(sph_drag(single, 0.3f, 2.0f, distance), drag[l], 1e-5 * (1.0 + drag[l]));
  }
}

TEST_F(Laws, WallsOfLiquidScaleWithTheSupport) {
  // What the GPU computes over H is what the CPU computes in metres.
  constexpr double kSupport = 0.03;
  const SphKernels<double> kernels(kSupport), unit(1.0);
  for (double s = 0.01; s < 1.1; s += 0.05) {
    EXPECT_NEAR(wall_filling(kernels, s * kSupport), wall_filling(unit, s), 1e-12);
    const double push = wall_push(kernels, 1.0, 1e4, 1.1, s * kSupport) * kSupport;
    EXPECT_NEAR(push, wall_push(unit, 1.0, 1e4, 1.1, s), 1e-9 * 1e4);
    const double drag = wall_drag(kernels, 1.0, 2.0, s * kSupport) * kSupport * kSupport;
    EXPECT_NEAR(drag, wall_drag(unit, 1.0, 2.0, s), 1e-9 * std::max(1.0, drag));
  }
  EXPECT_EQ(wall_push(unit, 1.0, 1e4, 0.9, 0.1), 0.0) << "a wall does not pull";
  EXPECT_LE(wall_filling(unit, -0.25), kWallMostFilled);
}

TEST_F(Laws, SpringsAndCellsPullBack) {
  EXPECT_EQ(spring_share(100.0, 1.0, 1.0), 0.0);
  EXPECT_GT(spring_share(100.0, 1.0, 1.1), 0.0) << "a long spring pulls";
  EXPECT_LT(spring_share(100.0, 1.0, 0.9), 0.0);
  EXPECT_EQ(cell_share(100.0, 1.2, 1.2), 0.0);
  EXPECT_GT(cell_share(100.0, 1.3, 1.2), 0.0);
  EXPECT_EQ(divisor(0.0f), kNoDirection<float>);
  EXPECT_TRUE(std::isnan(divisor(std::nan("")))) << "what is no number stays none";
  for (int k = 0; k < kCount; ++k) {
    const double rest = number(0.5, 1.5), length = number(0.1, 2.0);
    EXPECT_NEAR(spring_share(10.0f, static_cast<float>(rest), static_cast<float>(length)),
                spring_share(10.0, rest, length), 1e-4);
  }
}

TEST_F(Laws, FrictionIsTheNearestForceInTheDisk) {
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Vector3d force = vector(2.0);
    const double bound = number(0.1, 2.0);
    const Eigen::Vector3d held = within_disk(force, bound);
    EXPECT_LE(held.norm(), bound * (1.0 + 1e-14));
    EXPECT_NEAR((force - held).norm(), std::max(0.0, force.norm() - bound), 1e-14);
    expect_alike(in_double(within_disk(plain<float>(force), static_cast<float>(bound))), held,
                 kSingle, 2.0);
  }
}

template <class Distance, class Single>
void compare_shapes(const Eigen::Vector3d& p, const Distance& exact, const Single& single) {
  EXPECT_NEAR(static_cast<double>(single.distance), exact.distance, 1e-6);
  if (std::abs(exact.distance) > 1e-3) {
    expect_alike(in_double(single.normal), exact.normal, 1e-4, 1.0);
  }
  EXPECT_NEAR(exact.normal.norm(), 1.0, 1e-12) << p.transpose();
}

TEST_F(Laws, DistancesOfShapesAreAlike) {
  const Eigen::Vector3d half(0.25, 0.5, 0.75);
  for (int k = 0; k < kCount; ++k) {
    const Eigen::Vector3d p = vector(1.0);
    const Float3 q = plain<float>(p);
    compare_shapes(p, distance_to_plane(p), distance_to_plane(q));
    compare_shapes(p, distance_to_sphere(p, 0.5), distance_to_sphere(q, 0.5f));
    compare_shapes(p, distance_to_box(p, half), distance_to_box(q, plain<float>(half)));
    compare_shapes(p, distance_to_capsule(p, 0.25, 0.5), distance_to_capsule(q, 0.25f, 0.5f));
    compare_shapes(p, distance_to_cylinder(p, 0.25, 0.5), distance_to_cylinder(q, 0.25f, 0.5f));
  }
  // Where the gradient does not exist.
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_EQ(distance_to_sphere(none, 0.5).normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(distance_to_capsule(none, 0.25, 0.5).normal, Eigen::Vector3d::UnitX());
}

}  // namespace
}  // namespace pliant
