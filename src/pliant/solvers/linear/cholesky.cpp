#include "pliant/solvers/linear/cholesky.h"

#include <algorithm>
#include <cstring>

#include "pliant/math/error.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kWidest = 4;

// Three right-hand sides, and a fourth that nothing uses.
using Four = double __attribute__((vector_size(4 * sizeof(double))));

inline __attribute__((always_inline)) Four load(const double* v, int row) {
  Four four;
  std::memcpy(&four, v + 4 * static_cast<std::ptrdiff_t>(row), sizeof four);
  return four;
}

inline __attribute__((always_inline)) void store(const Four& four, double* v, int row) {
  std::memcpy(v + 4 * static_cast<std::ptrdiff_t>(row), &four, sizeof four);
}

/// L x = v of the columns of a panel.
template <int kWidth>
inline __attribute__((always_inline)) void solve_forward(const CholeskySolver::Panel& panel,
                                                         const int* rows, const double* values,
                                                         double* v) {
  Four x[kWidth];
  const double* below = values + kWidth;
  for (int c = 0; c < kWidth; ++c) {
    x[c] = load(v, panel.column + c);
    for (int d = 0; d < c; ++d) x[c] -= *below++ * x[d];
    x[c] *= values[c];
    store(x[c], v, panel.column + c);
  }
  for (int r = 0; r < panel.rows; ++r, below += kWidth) {
    Four to = load(v, rows[r]);
    for (int c = 0; c < kWidth; ++c) to -= below[c] * x[c];
    store(to, v, rows[r]);
  }
}

/// Lᵀ x = v of the columns of a panel.
template <int kWidth>
inline __attribute__((always_inline)) void solve_backward(const CholeskySolver::Panel& panel,
                                                          const int* rows, const double* values,
                                                          double* v) {
  Four x[kWidth];
  for (int c = 0; c < kWidth; ++c) x[c] = load(v, panel.column + c);
  const double* below = values + kWidth + kWidth * (kWidth - 1) / 2;
  for (int r = 0; r < panel.rows; ++r, below += kWidth) {
    const Four other = load(v, rows[r]);
    for (int c = 0; c < kWidth; ++c) x[c] -= below[c] * other;
  }
  for (int c = kWidth - 1; c >= 0; --c) {
    x[c] *= values[c];
    store(x[c], v, panel.column + c);
    const double* row = values + kWidth + c * (c - 1) / 2;
    for (int d = 0; d < c; ++d) x[d] -= row[d] * x[c];
  }
}

/// L Lᵀ x = v in place, 4 numbers a row.
PLIANT_WIDEST void solve_factor(const std::vector<CholeskySolver::Panel>& panels, const int* rows,
                                const double* values, double* v) {
  for (const auto& panel : panels) {
    const int* below = rows + panel.first_row;
    const double* own = values + panel.numbers;
    switch (panel.width) {
      case 1:
        solve_forward<1>(panel, below, own, v);
        break;
      case 2:
        solve_forward<2>(panel, below, own, v);
        break;
      case 3:
        solve_forward<3>(panel, below, own, v);
        break;
      default:
        solve_forward<kWidest>(panel, below, own, v);
    }
  }
  for (auto panel = panels.rbegin(); panel != panels.rend(); ++panel) {
    const int* below = rows + panel->first_row;
    const double* own = values + panel->numbers;
    switch (panel->width) {
      case 1:
        solve_backward<1>(*panel, below, own, v);
        break;
      case 2:
        solve_backward<2>(*panel, below, own, v);
        break;
      case 3:
        solve_backward<3>(*panel, below, own, v);
        break;
      default:
        solve_backward<kWidest>(*panel, below, own, v);
    }
  }
}

/// Whether the next column of L begins with the second row of this one and goes on like it.
bool goes_on(const Eigen::SparseMatrix<double>& factor, int column) {
  const int *begins = factor.outerIndexPtr() + column, *rows = factor.innerIndexPtr();
  return column + 1 < factor.cols() && begins[2] - begins[1] == begins[1] - begins[0] - 1 &&
         std::equal(rows + begins[0] + 1, rows + begins[1], rows + begins[1]);
}

}  // namespace

void CholeskySolver::factor(const SparseRows& a) {
  Eigen::SimplicialLLT<Factor, Eigen::Lower, Eigen::AMDOrdering<int>> llt;
  llt.compute(Factor(a));
  if (llt.info() != Eigen::Success) {
    throw InputError(
        "the system of masses and stiffnesses is not positive definite to round-off: stiffnesses "
        "differ by too much; take a smaller time step, or the solver jacobi or xpbd");
  }
  split(Factor(llt.matrixL()));
  order_ = llt.permutationPinv().indices();
  permuted_.setZero(4, a.rows());
}

void CholeskySolver::split(const Factor& factor) {
  panels_.clear();
  rows_.clear();
  values_.clear();
  nonzeros_ = factor.nonZeros();
  for (int column = 0, width = 1; column < factor.cols(); column += width) {
    width = 1;
    while (width < kWidest && goes_on(factor, column + width - 1)) ++width;
    add_panel(factor, column, width);
  }
}

void CholeskySolver::add_panel(const Factor& factor, int column, int width) {
  // Of column c the entry of the panel's row r, its columns' own ones first, is number r − c.
  const auto entry = [&](int r, int c) {
    return factor.valuePtr()[factor.outerIndexPtr()[column + c] + r - c];
  };
  const int begin = factor.outerIndexPtr()[column] + width;
  const int end = factor.outerIndexPtr()[column + 1];
  panels_.push_back({column, width, static_cast<int>(rows_.size()), end - begin,
                     static_cast<std::ptrdiff_t>(values_.size())});
  rows_.insert(rows_.end(), factor.innerIndexPtr() + begin, factor.innerIndexPtr() + end);
  for (int c = 0; c < width; ++c) values_.push_back(1.0 / entry(c, c));
  for (int r = 1; r < width; ++r) {
    for (int c = 0; c < r; ++c) values_.push_back(entry(r, c));
  }
  for (int r = width; r < width + end - begin; ++r) {
    for (int c = 0; c < width; ++c) values_.push_back(entry(r, c));
  }
}

void CholeskySolver::solve(Eigen::Matrix3Xd& b) {
  const int n = static_cast<int>(permuted_.cols());
  for (int j = 0; j < n; ++j) permuted_.col(j).head<3>() = b.col(order_[j]);
  solve_factor(panels_, rows_.data(), values_.data(), permuted_.data());
  for (int j = 0; j < n; ++j) b.col(order_[j]) = permuted_.col(j).head<3>();
}

}  // namespace pliant
