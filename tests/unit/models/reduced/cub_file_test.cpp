#include "pliant/models/reduced/files/cub_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "pliant/math/error.h"
#include "support/random.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr int kRank = 4;

/// A potential as full symmetric tensors, V = ½ Σ K q q + Σ C q q q + Σ D q q q q, and its force
/// written as the library's loops write it.
struct Tensors {
  Eigen::MatrixXd k;
  double c[kRank][kRank][kRank], d[kRank][kRank][kRank][kRank];
};

/// V = Σ over a few directions of even and odd powers: symmetric by construction.
Tensors some_tensors() {
  Random random(7);
  Tensors t{Eigen::MatrixXd::Zero(kRank, kRank), {}, {}};
  for (int n = 0; n < 12; ++n) {
    Eigen::VectorXd a(kRank);
    for (int i = 0; i < kRank; ++i) a[i] = random(-1.0, 1.0);
    t.k += 50.0 * a * a.transpose();
    for (int i = 0; i < kRank; ++i) {
      for (int j = 0; j < kRank; ++j) {
        for (int k = 0; k < kRank; ++k) {
          t.c[i][j][k] += a[i] * a[j] * a[k];
          for (int l = 0; l < kRank; ++l) t.d[i][j][k][l] += a[i] * a[j] * a[k] * a[l];
        }
      }
    }
  }
  return t;
}

double energy(const Tensors& t, const Eigen::VectorXd& q) {
  double v = 0.5 * q.dot(t.k * q);
  for (int i = 0; i < kRank; ++i) {
    for (int j = 0; j < kRank; ++j) {
      for (int k = 0; k < kRank; ++k) {
        v += t.c[i][j][k] * q[i] * q[j] * q[k];
        for (int l = 0; l < kRank; ++l) v += t.d[i][j][k][l] * q[i] * q[j] * q[k] * q[l];
      }
    }
  }
  return v;
}

template <class Number>
void append(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// In how many orders i <= j <= k can stand.
int orders(int i, int j, int k) { return i == k ? 1 : i == j || j == k ? 3 : 6; }

std::string cub_of(const Tensors& t) {
  std::string bytes;
  for (const int size :
       {kRank, kRank, kRank * (kRank + 1) / 2, kRank * (kRank + 1) * (kRank + 2) / 6}) {
    append(bytes, static_cast<std::int32_t>(size));
  }
  for (int l = 0; l < kRank; ++l) {
    for (int i = 0; i < kRank; ++i) append(bytes, t.k(l, i));
  }
  for (int l = 0; l < kRank; ++l) {
    for (int i = 0; i < kRank; ++i) {
      for (int j = i; j < kRank; ++j) append(bytes, 3.0 * t.c[l][i][j] * (i == j ? 1 : 2));
    }
  }
  for (int l = 0; l < kRank; ++l) {
    for (int i = 0; i < kRank; ++i) {
      for (int j = i; j < kRank; ++j) {
        for (int k = j; k < kRank; ++k) append(bytes, 4.0 * t.d[l][i][j][k] * orders(i, j, k));
      }
    }
  }
  return bytes;
}

class CubFile : public testing::Test {
 protected:
  std::string written(const std::string& bytes) {
    const std::string path = files_.path("body.cub");
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  void expect_refused(const std::string& bytes, const std::string& part) {
    try {
      read_cub(written(bytes));
      FAIL() << "not refused: " << part;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("body.cub"), std::string::npos) << error.what();
    }
  }
  SceneFiles files_;
};

TEST_F(CubFile, HoldsTheSamePotentialInCoordinatesThatMakeItsStiffnessDiagonal) {
  const Tensors t = some_tensors();
  const CubPotential read = read_cub(written(cub_of(t)));
  ASSERT_EQ(read.potential.rank(), kRank);
  EXPECT_LT((read.rotation.transpose() * read.rotation - Eigen::MatrixXd::Identity(kRank, kRank))
                .cwiseAbs()
                .maxCoeff(),
            1e-14);
  QuarticPotential::Workspace space;
  Random random(3);
  for (int trial = 0; trial < 10; ++trial) {
    Eigen::VectorXd q(kRank);
    for (int i = 0; i < kRank; ++i) q[i] = random(-2.0, 2.0);
    const double expected = energy(t, read.rotation * q);
    EXPECT_NEAR(read.potential.energy(q, space), expected, 1e-12 * std::abs(expected));
  }
}

TEST_F(CubFile, ItsForceIsTheFilesPolynomial) {
  const Tensors t = some_tensors();
  const CubPotential read = read_cub(written(cub_of(t)));
  QuarticPotential::Workspace space;
  Eigen::VectorXd q(kRank), r;
  q << 0.3, -0.7, 1.1, 0.2;
  const Eigen::VectorXd z = read.rotation * q;
  Eigen::VectorXd force = t.k * z;
  for (int l = 0; l < kRank; ++l) {
    for (int i = 0; i < kRank; ++i) {
      for (int j = 0; j < kRank; ++j) {
        force[l] += 3.0 * t.c[l][i][j] * z[i] * z[j];
        for (int k = 0; k < kRank; ++k) force[l] += 4.0 * t.d[l][i][j][k] * z[i] * z[j] * z[k];
      }
    }
  }
  read.potential.evaluate(q, r, space);
  EXPECT_LT((read.rotation * r - force).norm(), 1e-12 * force.norm());
}

TEST_F(CubFile, RefusesWhatIsNone) {
  const std::string good = cub_of(some_tensors());
  expect_refused("", "too few");
  expect_refused(good.substr(0, 10), "too few");
  expect_refused(good.substr(0, good.size() - 1), "cut short");
  expect_refused(good + "x", "bytes, but rank");
  const auto with_int = [&](std::size_t at, std::int32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return bytes;
  };
  for (const int rank : {0, -1, 61, 0x04000000}) expect_refused(with_int(0, rank), "rank is");
  for (const std::size_t at : {4u, 8u, 12u}) expect_refused(with_int(at, 5), "do not belong");
  const auto with_number = [&](std::size_t at, double value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + 16 + 8 * at, &value, sizeof value);
    return bytes;
  };
  expect_refused(with_number(3, std::nan("")), "not finite");
  expect_refused(with_number(0, -1e6), "no equilibrium");
  // A linear, quadratic and cubic coefficient that no other component agrees with.
  expect_refused(with_number(1, 1e3), "degree 1");
  expect_refused(with_number(16 + 1, 1e3), "degree 2");
  expect_refused(with_number(16 + 40 + 1, 1e3), "degree 3");
  EXPECT_THROW(read_cub(files_.path("none.cub")), InputError);
}

}  // namespace
}  // namespace pliant
