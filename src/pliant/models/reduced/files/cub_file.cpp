#include "pliant/models/reduced/files/cub_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"
#include "pliant/math/symmetric_eigen.h"

namespace pliant {
namespace {

constexpr double kAsymmetry = 1e-6;
constexpr int kMaxCubRank = 60;  // its quartic terms as a full tensor are then 100 MB

/// Coefficients of a polynomial force as the file has them.
class CubPolynomial {
 public:
  CubPolynomial(std::vector<double> linear, std::vector<double> quadratic,
                std::vector<double> cubic, int rank)
      : rank_(rank),
        linear_(std::move(linear)),
        quadratic_(std::move(quadratic)),
        cubic_(std::move(cubic)) {}

  int rank() const { return rank_; }
  double linear(int l, int i) const { return linear_[at(l, rank_, i)]; }
  /// Of qᵢ qⱼ in component l, i <= j.
  double quadratic(int l, int i, int j) const {
    return quadratic_[at(l, pairs(rank_), pairs(rank_) - pairs(rank_ - i) + j - i)];
  }
  /// Of qᵢ qⱼ qₖ in component l, i <= j <= k.
  double cubic(int l, int i, int j, int k) const {
    const int rest = rank_ - i;
    const int place = triples(rank_) - triples(rest) + pairs(rest) - pairs(rest - (j - i)) + k - j;
    return cubic_[at(l, triples(rank_), place)];
  }
  const std::vector<double>& of_degree(int degree) const {
    return degree == 1 ? linear_ : degree == 2 ? quadratic_ : cubic_;
  }

  static int pairs(int r) { return r * (r + 1) / 2; }
  static int triples(int r) { return r * (r + 1) * (r + 2) / 6; }

 private:
  static std::size_t at(int component, int size, int place) {
    return static_cast<std::size_t>(component) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(place);
  }
  int rank_;
  std::vector<double> linear_, quadratic_, cubic_;
};

/// A symmetric tensor of degree + 1 indices of the potential, each entry from each component that
/// has it. Throws where they contradict each other.
class CubGradient {
 public:
  CubGradient(const CubPolynomial& force, const std::string& path) : force_(force), path_(path) {
    for (int degree = 1; degree <= 3; ++degree) {
      for (const double c : force.of_degree(degree)) {
        largest_[degree] = std::max(largest_[degree], std::abs(c));
      }
    }
  }

  /// Coefficient of the product of the sorted coordinates in the potential: a component l of the
  /// force has it, times how often l is among them.
  template <std::size_t kCount>
  double operator()(const std::array<int, kCount>& sorted) const {
    double sum = 0.0, low = 0.0, high = 0.0;
    int components = 0;
    for (std::size_t n = 0; n < kCount; ++n) {
      if (n > 0 && sorted[n] == sorted[n - 1]) continue;
      const auto often = std::count(sorted.begin(), sorted.end(), sorted[n]);
      const double value = without(sorted, n) / static_cast<double>(often);
      low = components == 0 ? value : std::min(low, value);
      high = components == 0 ? value : std::max(high, value);
      sum += value;
      ++components;
    }
    if (high - low > kAsymmetry * largest_[kCount - 1]) {
      throw InputError(fmt::format(
          "{}: its terms of degree {} are not the gradient of a potential: components of the "
          "force contradict each other by {:.3g}",
          path_, kCount - 1, high - low));
    }
    return sum / components;
  }

 private:
  double without(const std::array<int, 2>& s, std::size_t n) const {
    return force_.linear(s[n], s[1 - n]);
  }
  double without(const std::array<int, 3>& s, std::size_t n) const {
    return force_.quadratic(s[n], s[n == 0 ? 1 : 0], s[n == 2 ? 1 : 2]);
  }
  double without(const std::array<int, 4>& s, std::size_t n) const {
    return force_.cubic(s[n], s[n == 0 ? 1 : 0], s[n <= 1 ? 2 : 1], s[n == 3 ? 2 : 3]);
  }
  const CubPolynomial& force_;
  const std::string& path_;
  double largest_[4] = {};
};

std::vector<double> take(const char*& from, std::size_t count, const std::string& path) {
  std::vector<double> values(count);
  std::memcpy(values.data(), from, count * sizeof(double));
  from += count * sizeof(double);
  for (const double value : values) {
    if (!std::isfinite(value)) {
      throw InputError(fmt::format("{}: a coefficient is not finite", path));
    }
  }
  return values;
}

CubPolynomial parse(const std::string& bytes, const std::string& path) {
  std::int32_t sizes[4];
  if (bytes.size() < sizeof sizes) {
    throw InputError(fmt::format("{}: {} bytes are too few for a .cub file", path, bytes.size()));
  }
  std::memcpy(sizes, bytes.data(), sizeof sizes);
  const int r = sizes[0];
  if (r < 1 || r > kMaxCubRank) {
    throw InputError(
        fmt::format("{}: rank is {}, but must be from 1 to {}: no .cub file, or one of another "
                    "byte order",
                    path, r, kMaxCubRank));
  }
  const int pairs = CubPolynomial::pairs(r), triples = CubPolynomial::triples(r);
  if (sizes[1] != r || sizes[2] != pairs || sizes[3] != triples) {
    throw InputError(fmt::format("{}: sizes {}, {}, {} do not belong to rank {}: {}, {}, {}", path,
                                 sizes[1], sizes[2], sizes[3], r, r, pairs, triples));
  }
  const auto count = [r](int size) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(size);
  };
  const std::size_t wanted =
      sizeof sizes + sizeof(double) * (count(r) + count(pairs) + count(triples));
  if (bytes.size() != wanted) {
    throw InputError(fmt::format("{}: {} bytes, but rank {} has {}: it was cut short, or is none",
                                 path, bytes.size(), r, wanted));
  }
  const char* from = bytes.data() + sizeof sizes;
  std::vector<double> linear = take(from, count(r), path);
  std::vector<double> quadratic = take(from, count(pairs), path);
  std::vector<double> cubic = take(from, count(triples), path);
  return CubPolynomial(std::move(linear), std::move(quadratic), std::move(cubic), r);
}

/// Full symmetric tensor entries of a polynomial's coefficients, turned: t'(a, ...) = Σ Q(i, a) ...
/// t(i, ...). `t` has rank^order numbers, the first index fastest.
std::vector<double> turned(std::vector<double> t, const Eigen::MatrixXd& q, int order) {
  const Eigen::Index r = q.rows(), rest = static_cast<Eigen::Index>(t.size()) / r;
  for (int n = 0; n < order; ++n) {  // each product turns one index and makes it the last
    const Eigen::Map<const Eigen::MatrixXd> matrix(t.data(), r, rest);
    const Eigen::MatrixXd next = matrix.transpose() * q;
    std::copy(next.data(), next.data() + next.size(), t.begin());
  }
  return t;
}

/// In how many orders the sorted indices can stand.
template <std::size_t kCount>
double orders(const std::array<int, kCount>& sorted) {
  double count = 1.0;
  int same = 0;
  for (std::size_t n = 0; n < kCount; ++n) {
    same = n > 0 && sorted[n] == sorted[n - 1] ? same + 1 : 1;
    count *= static_cast<double>(n + 1) / same;
  }
  return count;
}

template <std::size_t kCount>
std::vector<double> tensor_of(const CubGradient& gradient, int r) {
  std::size_t size = 1;
  for (std::size_t n = 0; n < kCount; ++n) size *= static_cast<std::size_t>(r);
  std::vector<double> t(size);
  for (std::size_t c = 0; c < size; ++c) {
    std::array<int, kCount> indices;
    std::size_t left = c;
    for (int& index : indices) {
      index = static_cast<int>(left % static_cast<std::size_t>(r));
      left /= static_cast<std::size_t>(r);
    }
    std::sort(indices.begin(), indices.end());
    t[c] = gradient(indices) / orders(indices);
  }
  return t;
}

}  // namespace

CubPotential read_cub(const std::string& path) {
  const CubPolynomial force = parse(read_bytes(path), path);
  const CubGradient gradient(force, path);
  const int r = force.rank();

  const std::vector<double> half_k = tensor_of<2>(gradient, r);
  const Eigen::Map<const Eigen::MatrixXd> half(half_k.data(), r, r);
  SymmetricEigen eigen = symmetric_eigen(2.0 * half);
  Eigen::VectorXd& lambda = eigen.values;
  if (lambda[0] < -kAsymmetry * lambda.cwiseAbs().maxCoeff()) {
    throw InputError(fmt::format(
        "{}: at rest its stiffness has the eigenvalue {:.3g}: no equilibrium", path, lambda[0]));
  }
  lambda = lambda.cwiseMax(0.0);
  CubPotential result;
  result.rotation = std::move(eigen.vectors);

  const std::vector<double> t3 = turned(tensor_of<3>(gradient, r), result.rotation, 3);
  const std::vector<double> t4 = turned(tensor_of<4>(gradient, r), result.rotation, 4);
  std::vector<double> coefficients(
      static_cast<std::size_t>(QuarticPotential::coefficient_count(r)));
  const auto place = [](std::int64_t index) { return static_cast<std::size_t>(index); };
  const auto n = static_cast<std::size_t>(r);
  for (int k = 0; k < r; ++k) {
    for (int j = 0; j <= k; ++j) {
      for (int i = 0; i <= j; ++i) {
        const std::size_t at = static_cast<std::size_t>(i) +
                               n * (static_cast<std::size_t>(j) + n * static_cast<std::size_t>(k));
        coefficients[place(QuarticPotential::index(r, i, j, k))] =
            t3[at] * orders(std::array<int, 3>{i, j, k});
        for (int l = k; l < r; ++l) {
          coefficients[place(QuarticPotential::index(r, i, j, k, l))] =
              t4[at + n * n * n * static_cast<std::size_t>(l)] *
              orders(std::array<int, 4>{i, j, k, l});
        }
      }
    }
  }
  result.potential = QuarticPotential(std::move(lambda), coefficients, path);
  return result;
}

}  // namespace pliant
