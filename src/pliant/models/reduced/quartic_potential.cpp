#include "pliant/models/reduced/quartic_potential.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Pairs i <= j < count.
constexpr std::int64_t pairs(std::int64_t count) { return count * (count + 1) / 2; }
int pairs_int(int count) { return static_cast<int>(pairs(count)); }

void check(const Eigen::VectorXd& lambda, const std::vector<double>& coefficients,
           const std::string& where) {
  const auto rank = lambda.size();
  if (rank < 1 || rank > kMaxRank) {
    throw InputError(
        fmt::format("{}: rank is {}, but must be from 1 to {}", where, rank, kMaxRank));
  }
  for (Eigen::Index i = 0; i < rank; ++i) {
    if (std::isfinite(lambda[i]) && lambda[i] >= 0.0) continue;
    throw InputError(fmt::format("{}: squared frequency {} is {}, but must be finite and >= 0",
                                 where, i, lambda[i]));
  }
  const std::int64_t count = QuarticPotential::coefficient_count(static_cast<int>(rank));
  if (static_cast<std::int64_t>(coefficients.size()) != count) {
    throw InputError(fmt::format("{}: {} coefficients, but rank {} has {}", where,
                                 coefficients.size(), rank, count));
  }
  for (std::size_t c = 0; c < coefficients.size(); ++c) {
    if (std::isfinite(coefficients[c])) continue;
    throw InputError(fmt::format("{}: coefficient {} is not finite", where, c));
  }
}

/// r += Jᵀ g, J the derivative of the products s: each pair (i, j) gives gᵢⱼ qⱼ to i and gᵢⱼ qᵢ to
/// j.
void pull_back(const double* g, const Eigen::VectorXd& q, double* r) {
  for (Eigen::Index j = 0; j < q.size(); g += ++j) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i <= j; ++i) {
      sum += g[i] * q[i];
      r[i] += g[i] * q[j];
    }
    r[j] += sum;
  }
}

const double* numbers(const LaneVector& lanes) {
  return reinterpret_cast<const double*>(lanes.data());
}

}  // namespace

std::int64_t QuarticPotential::coefficient_count(int rank) {
  const std::int64_t r = rank;
  return r * (r + 1) * (r + 2) / 6 + r * (r + 1) * (r + 2) * (r + 3) / 24;
}

std::int64_t QuarticPotential::index(int rank, int i, int j, int k) {
  std::int64_t begin = 0;
  for (int b = 0; b < k; ++b) begin += pairs(b + 1) * (rank - b + 1);
  return begin + pairs(j) + i;
}

std::int64_t QuarticPotential::index(int rank, int i, int j, int k, int l) {
  return index(rank, i, j, k) + pairs(k + 1) * (l - k + 1);
}

QuarticPotential::QuarticPotential(Eigen::VectorXd lambda, const std::vector<double>& coefficients,
                                   const std::string& where) {
  check(lambda, coefficients, where);
  lambda_ = std::move(lambda);
  std::size_t size = 0;
  for (int k = 0; k < rank(); ++k) {
    begins_.push_back(size);
    size += static_cast<std::size_t>((rank() - k + 1) * lanes_for(pairs_int(k + 1)));
  }
  blocks_.assign(size, Lanes{});
  auto from = coefficients.begin();
  for (int k = 0; k < rank(); ++k) {
    const CoefficientRows rows = block(k);
    auto* to = reinterpret_cast<double*>(blocks_.data() + begins_[static_cast<std::size_t>(k)]);
    for (int row = 0; row < rows.rows; ++row, from += pairs_int(k + 1), to += rows.lanes * kLanes) {
      std::copy(from, from + pairs_int(k + 1), to);
    }
  }
}

std::vector<double> QuarticPotential::coefficients() const {
  std::vector<double> all;
  all.reserve(static_cast<std::size_t>(coefficient_count(rank())));
  for (int k = 0; k < rank(); ++k) {
    const CoefficientRows rows = block(k);
    const auto* from = reinterpret_cast<const double*>(rows.begin);
    for (int row = 0; row < rows.rows; ++row, from += rows.lanes * kLanes) {
      all.insert(all.end(), from, from + pairs_int(k + 1));
    }
  }
  return all;
}

CoefficientRows QuarticPotential::block(int k) const {
  return {blocks_.data() + begins_[static_cast<std::size_t>(k)], rank() - k + 1,
          lanes_for(pairs_int(k + 1))};
}

void QuarticPotential::prepare(const Eigen::VectorXd& q, Workspace& workspace) const {
  const auto lanes = static_cast<std::size_t>(lanes_for(pairs_int(rank())));
  workspace.s.assign(lanes, Lanes{});
  workspace.sum.assign(lanes, Lanes{});
  workspace.weights.resize(static_cast<std::size_t>(rank()) + 1);
  workspace.dots.resize(static_cast<std::size_t>(rank()) + 1);
  auto* s = reinterpret_cast<double*>(workspace.s.data());
  for (int j = 0; j < rank(); s += ++j) {
    for (int i = 0; i <= j; ++i) s[i] = q[i] * q[j];
  }
}

void QuarticPotential::set_weights(const Eigen::VectorXd& q, int k, double scale,
                                   Workspace& workspace) const {
  double* weights = workspace.weights.data();
  weights[0] = scale;
  for (int l = k; l < rank(); ++l) weights[l - k + 1] = scale * q[l];
}

double QuarticPotential::energy(const Eigen::VectorXd& q, Workspace& workspace) const {
  Eigen::VectorXd r;
  return evaluate(q, r, workspace);
}

double QuarticPotential::evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& r,
                                  Workspace& workspace) const {
  const int n = rank();
  double padded_q[kMaxRank + 2 * kLanes], padded_r[kMaxRank + 2 * kLanes];
  std::copy(q.data(), q.data() + n, padded_q);
  std::fill(padded_q + n, padded_q + n + 2 * kLanes, 0.0);
  double energy = 0.0;
  for (int i = 0; i < n; ++i) {
    padded_r[i] = lambda_[i] * q[i];
    energy += 0.5 * padded_r[i] * q[i];
  }
  std::fill(padded_r + n, padded_r + n + 2 * kLanes, 0.0);
  energy += add_force(blocks_.data(), n, padded_q, padded_r, workspace.force);
  r = Eigen::Map<const Eigen::VectorXd>(padded_r, n);
  return energy;
}

double QuarticPotential::evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& r, Eigen::MatrixXd& k,
                                  Workspace& workspace) const {
  prepare(q, workspace);
  const int n = rank();
  const auto stride = static_cast<std::ptrdiff_t>(workspace.s.size());
  // Row a holds ∂/∂qₐ of the factors of s: Yₐ = aₐ + Σ_{l≥a} qₗ c_al + Σ_{k≤a} qₖ c_ka.
  workspace.spread.assign(static_cast<std::size_t>(n) * workspace.s.size(), Lanes{});
  r = lambda_.cwiseProduct(q);
  k = lambda_.asDiagonal();
  double energy = 0.5 * r.dot(q);
  const double* dots = workspace.dots.data();
  for (int b = 0; b < n; ++b) {
    set_weights(q, b, 1.0, workspace);
    const CoefficientRows rows = block(b);
    Lanes* target = workspace.spread.data() + b * stride;
    workspace.row_sum.assign(static_cast<std::size_t>(rows.lanes), Lanes{});
    contract({rows.begin, 1, rows.lanes}, workspace.weights.data(), workspace.s.data(),
             workspace.row_sum.data(), workspace.dots.data());
    contract_and_spread({rows.begin + rows.lanes, rows.rows - 1, rows.lanes},
                        workspace.weights.data() + 1, q[b], workspace.s.data(),
                        workspace.row_sum.data(), target, stride, workspace.dots.data() + 1);
    for (int p = 0; p < rows.lanes; ++p) {
      const Lanes sum = workspace.row_sum[static_cast<std::size_t>(p)];
      workspace.sum[static_cast<std::size_t>(p)] += q[b] * sum;
      target[p] += sum;
    }
    double sum = dots[0];
    for (int l = b; l < n; ++l) {
      const double dot = dots[l - b + 1];
      sum += q[l] * dot;
      r[l] += q[b] * dot;
      k(b, l) += dot;
      k(l, b) += dot;
    }
    r[b] += sum;
    energy += q[b] * sum;
  }
  const double* g = numbers(workspace.sum);
  pull_back(g, q, r.data());
  for (int j = 0; j < n; g += ++j) {
    for (int i = 0; i <= j; ++i) {
      k(i, j) += g[i];
      k(j, i) += g[i];
    }
  }
  Eigen::VectorXd& column = workspace.column;
  for (int a = 0; a < n; ++a) {
    column.setZero(n);
    pull_back(numbers(workspace.spread) + a * stride * kLanes, q, column.data());
    k.col(a) += column;
    k.row(a) += column;
  }
  return energy;
}

}  // namespace pliant
