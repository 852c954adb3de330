#include "pliant/models/reduced/project_potential.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A symmetric matrix's six entries, those beside the diagonal times √2: products are those of
/// matrices.
Vector6 packed(const Eigen::Matrix3d& a) {
  Vector6 v;
  v << a(0, 0), a(1, 1), a(2, 2), M_SQRT1_2 * (a(0, 1) + a(1, 0)), M_SQRT1_2 * (a(0, 2) + a(2, 0)),
      M_SQRT1_2 * (a(1, 2) + a(2, 1));
  return v;
}

/// Fᵀ with W = ½ v |Fᵀ E|² of a part.
Matrix6 stiffness_root(const StvkBody& body, int part) {
  Matrix6 d = Matrix6::Zero();
  if (body.lame(part).mu == 0.0) {
    // ½ λ tr(E)²
    d.row(0).head<3>().setConstant(std::sqrt(body.lame(part).lambda));
    return d;
  }
  for (int c = 0; c < 6; ++c) {
    Eigen::Matrix3d unit = Eigen::Matrix3d::Zero();
    constexpr int kRows[6] = {0, 1, 2, 0, 0, 1}, kColumns[6] = {0, 1, 2, 1, 2, 2};
    const double size = c < 3 ? 1.0 : M_SQRT1_2;
    unit(kRows[c], kColumns[c]) = unit(kColumns[c], kRows[c]) = size;
    d.col(c) = packed(body.stress(part, unit));
  }
  return Eigen::LLT<Matrix6>(d).matrixU();
}

/// The energy as a form of (q, s), s the products qᵢ qⱼ: its mixed and its quartic part.
class Forms {
 public:
  explicit Forms(int rank)
      : rank_(rank),
        pairs_(rank * (rank + 1) / 2),
        mixed_(Eigen::MatrixXd::Zero(rank, pairs_)),
        quartic_(Eigen::MatrixXd::Zero(pairs_, pairs_)) {}

  /// Strains of a batch of parts, 6 rows each, times F and √v.
  void add(const Eigen::MatrixXd& linear, const Eigen::MatrixXd& quadratic) {
    mixed_.noalias() += linear.transpose() * quadratic;
    quartic_.selfadjointView<Eigen::Lower>().rankUpdate(quadratic.transpose(), 0.5);
  }

  std::vector<double> coefficients() const {
    std::vector<double> all(static_cast<std::size_t>(QuarticPotential::coefficient_count(rank_)));
    const auto at = [&](auto... indices) -> double& {
      return all[static_cast<std::size_t>(QuarticPotential::index(rank_, indices...))];
    };
    for_each_pair([&](int i, int j, int p) {
      for (int a = 0; a < rank_; ++a) {
        std::array<int, 3> s{a, i, j};
        std::sort(s.begin(), s.end());
        at(s[0], s[1], s[2]) += mixed_(a, p);
      }
      for_each_pair([&](int k, int l, int o) {
        if (o > p) return;
        std::array<int, 4> s{i, j, k, l};
        std::sort(s.begin(), s.end());
        at(s[0], s[1], s[2], s[3]) += o == p ? quartic_(p, p) : 2.0 * quartic_(p, o);
      });
    });
    return all;
  }

  template <class Call>
  void for_each_pair(const Call& call) const {
    for (int j = 0, p = 0; j < rank_; ++j) {
      for (int i = 0; i <= j; ++i, ++p) call(i, j, p);
    }
  }
  int pairs() const { return pairs_; }

 private:
  int rank_;
  int pairs_;
  Eigen::MatrixXd mixed_;
  Eigen::MatrixXd quartic_;
};

}  // namespace

std::optional<QuarticPotential> project_potential(const StvkBody& body, const ReducedBasis& basis,
                                                  const ReduceProgress& progress) {
  const int rank = static_cast<int>(basis.u.cols());
  if (rank > kMaxRank) {
    throw InputError(fmt::format("rank is {}, but must be from 1 to {}", rank, kMaxRank));
  }
  const int parts = body.parts();
  std::vector<Eigen::MatrixXd> gradients;
  for (int i = 0; i < rank; ++i) gradients.push_back(body.gradients(basis.u.col(i)));
  Forms forms(rank);
  constexpr int kBatch = 64;
  for (int begin = 0; begin < parts; begin += kBatch) {
    if (!progress(begin, parts, "force polynomial")) return std::nullopt;
    const int count = std::min(kBatch, parts - begin);
    Eigen::MatrixXd linear(6 * count, rank), quadratic(6 * count, forms.pairs());
    for (int b = 0; b < count; ++b) {
      const int t = begin + b;
      const auto g = [&](int i) -> Eigen::Matrix3d {
        return gradients[static_cast<std::size_t>(i)].middleCols<3>(3 * t);
      };
      const Matrix6 f = std::sqrt(body.rest_volume(t)) * stiffness_root(body, t);
      for (int i = 0; i < rank; ++i) linear.block<6, 1>(6 * b, i) = f * packed(g(i));
      forms.for_each_pair([&](int i, int j, int p) {
        quadratic.block<6, 1>(6 * b, p) =
            f * packed(g(i).transpose() * g(j)) * (i == j ? 0.5 : 1.0);
      });
    }
    forms.add(linear, quadratic);
  }
  return QuarticPotential(basis.lambda, forms.coefficients(), "reduced potential");
}

}  // namespace pliant
