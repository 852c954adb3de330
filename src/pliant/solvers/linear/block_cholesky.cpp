#include "pliant/solvers/linear/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <cmath>
#include <cstring>

#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kSize = BlockCholesky::kSize;
constexpr int kWidth = 8;                // of the registers that hold a column of a block
constexpr int kEntries = kSize * kSize;  // of a block
// A column of a block; what the last two numbers are does not matter.
using Wide = double __attribute__((vector_size(kWidth * sizeof(double))));

// Of what a pivot was: what is left of one that is none.
constexpr double kNone = 1e-10;

/// Block = L Lᵀ, of which the block holds L⁻¹ afterwards, 0 above its diagonal. False where it is
/// not positive definite; unknowns without stiffness of their own do not count.
bool invert_factor(const Eigen::Matrix<double, kSize, 1>& was, BlockCholesky::Block& block) {
  BlockCholesky::Block l = block;
  bool is_definite = true;
  for (int k = 0; k < kSize; ++k) {
    double pivot = l(k, k);
    for (int c = 0; c < k; ++c) pivot -= l(k, c) * l(k, c);
    // An unknown without stiffness is held by one beyond all others.
    const bool is_none = !(pivot > kNone * was[k]);
    if (is_none && was[k] != 0.0) is_definite = false;
    l(k, k) = is_none ? 1e150 : std::sqrt(pivot);
    for (int r = k + 1; r < kSize; ++r) {
      double value = l(r, k);
      for (int c = 0; c < k; ++c) value -= l(r, c) * l(k, c);
      l(r, k) = is_none ? 0.0 : value / l(k, k);
    }
  }
  block.setZero();
  for (int c = 0; c < kSize; ++c) {
    block(c, c) = 1.0 / l(c, c);
    for (int r = c + 1; r < kSize; ++r) {
      double sum = 0.0;
      for (int k = c; k < r; ++k) sum += l(r, k) * block(k, c);
      block(r, c) = -sum / l(r, r);
    }
  }
  return is_definite;
}

/// b <- b xᵀ, x lower triangular.
PLIANT_WIDEST void divide_by_factor(const double* x, double* b) {
  Wide product[kSize];
  for (int c = 0; c < kSize; ++c) {
    product[c] = Wide{};
    for (int k = 0; k <= c; ++k) {
      Wide column;
      std::memcpy(&column, b + kSize * k, sizeof column);
      product[c] += column * x[kSize * k + c];
    }
  }
  for (int c = 0; c < kSize; ++c) {
    for (int r = 0; r < kSize; ++r) b[kSize * c + r] = product[c][r];
  }
}

/// c −= a bᵀ.
PLIANT_WIDEST void take_product(const double* a, const double* b, double* c) {
  for (int j = 0; j < kSize; ++j) {
    Wide sum;
    std::memcpy(&sum, c + kSize * j, sizeof sum);
    for (int k = 0; k < kSize; ++k) {
      Wide column;
      std::memcpy(&column, a + kSize * k, sizeof column);
      sum -= column * b[kSize * k + j];
    }
    for (int r = 0; r < kSize; ++r) c[kSize * j + r] = sum[r];
  }
}

/// L x = v from the first column on, in place; `v` holds kWidth numbers a row of blocks.
PLIANT_WIDEST void solve_forward(int size, const int* begins, const int* rows, const double* blocks,
                                 const double* inverses, double* v) {
  for (int j = 0; j < size; ++j) {
    double* at = v + kWidth * j;
    Wide x = Wide{};
    for (int k = 0; k < kSize; ++k) {
      Wide column;
      std::memcpy(&column, inverses + kEntries * j + kSize * k, sizeof column);
      x += column * at[k];
    }
    std::memcpy(at, &x, sizeof x);
    for (int e = begins[j]; e < begins[j + 1]; ++e) {
      const double* block = blocks + static_cast<std::ptrdiff_t>(kEntries) * e;
      double* to = v + kWidth * rows[e];
      Wide sum;
      std::memcpy(&sum, to, sizeof sum);
      for (int k = 0; k < kSize; ++k) {
        Wide column;
        std::memcpy(&column, block + kSize * k, sizeof column);
        sum -= column * at[k];
      }
      std::memcpy(to, &sum, sizeof sum);
    }
  }
}

/// Lᵀ x = v from the last column on, in place.
PLIANT_WIDEST void solve_backward(int size, const int* begins, const int* rows,
                                  const double* blocks, const double* inverses, double* v) {
  for (int j = size - 1; j >= 0; --j) {
    double* at = v + kWidth * j;
    Wide products[kSize] = {};
    for (int e = begins[j]; e < begins[j + 1]; ++e) {
      const double* block = blocks + static_cast<std::ptrdiff_t>(kEntries) * e;
      Wide x;
      std::memcpy(&x, v + kWidth * rows[e], sizeof x);
      for (int k = 0; k < kSize; ++k) {
        Wide column;
        std::memcpy(&column, block + kSize * k, sizeof column);
        products[k] += column * x;
      }
    }
    double left[kSize];
    for (int k = 0; k < kSize; ++k) {
      left[k] = at[k];
      for (int i = 0; i < kSize; ++i) left[k] -= products[k][i];
    }
    const double* inverse = inverses + kEntries * j;
    for (int k = 0; k < kSize; ++k) {
      at[k] = 0.0;
      for (int i = k; i < kSize; ++i) at[k] += inverse[kSize * k + i] * left[i];
    }
  }
}

}  // namespace

void BlockCholesky::analyze(int size, const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [row, column] : pairs) {
    entries.emplace_back(row, column, 1.0);
    entries.emplace_back(column, row, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  at_.assign(static_cast<std::size_t>(size), 0);
  // AMD's permutation lists the rows of A in their new order.
  for (int k = 0; k < size; ++k) at_[static_cast<std::size_t>(order.indices()[k])] = k;
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(size));
  for (int j = 0; j < size; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(pattern, j); entry; ++entry) {
      const int a = at_[static_cast<std::size_t>(entry.row())];
      const int b = at_[static_cast<std::size_t>(j)];
      if (a > b) columns[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  // A column's rows go on in the column of the first of them.
  begins_ = {0};
  rows_.clear();
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    if (column.size() > 1) {
      auto& parent = columns[static_cast<std::size_t>(column.front())];
      parent.insert(parent.end(), column.begin() + 1, column.end());
    }
    rows_.insert(rows_.end(), column.begin(), column.end());
    begins_.push_back(static_cast<int>(rows_.size()));
  }
  blocks_.assign(rows_.size() + static_cast<std::size_t>(size) + 1, Block::Zero());
  was_.resize(static_cast<std::size_t>(size));
  permuted_.assign(static_cast<std::size_t>(kWidth * size), 0.0);
}

void BlockCholesky::add(int row, int column, const Block& block) {
  const int a = at_[static_cast<std::size_t>(row)], b = at_[static_cast<std::size_t>(column)];
  if (a == b) {
    diagonal(a) += block;
  } else if (a > b) {
    blocks_[place(a, b)] += block;
  } else {
    blocks_[place(b, a)] += block.transpose();
  }
}

bool BlockCholesky::has(int row, int column) const {
  const int a = at_[static_cast<std::size_t>(row)], b = at_[static_cast<std::size_t>(column)];
  if (a == b) return true;
  const int lower = std::max(a, b), left = std::min(a, b);
  const std::size_t found = place(lower, left);
  const int end = begins_[static_cast<std::size_t>(left) + 1];
  return found < static_cast<std::size_t>(end) && rows_[found] == lower;
}

double BlockCholesky::products() const {
  double sum = 0.0;
  for (std::size_t j = 0; j + 1 < begins_.size(); ++j) {
    const double below = begins_[j + 1] - begins_[j];
    sum += 1.0 + below + 0.5 * below * (below + 1.0);
  }
  return sum;
}

bool BlockCholesky::factor() {
  bool is_definite = true;
  for (int j = 0; j < size(); ++j) was_[static_cast<std::size_t>(j)] = diagonal(j).diagonal();
  for (int j = 0; j < size(); ++j) {
    const auto column = static_cast<std::size_t>(j);
    is_definite &= invert_factor(was_[column], diagonal(j));
    const auto first = static_cast<std::size_t>(begins_[column]);
    const auto last = static_cast<std::size_t>(begins_[column + 1]);
    // L_ij = A_ij L_jj⁻ᵀ
    for (std::size_t e = first; e < last; ++e) {
      divide_by_factor(diagonal(j).data(), blocks_[e].data());
    }
    for (std::size_t e = first; e < last; ++e) {
      const int k = rows_[e];
      take_product(blocks_[e].data(), blocks_[e].data(), diagonal(k).data());
      auto to = static_cast<std::size_t>(begins_[static_cast<std::size_t>(k)]);
      for (std::size_t f = e + 1; f < last; ++f) {
        while (rows_[to] < rows_[f]) ++to;
        take_product(blocks_[f].data(), blocks_[e].data(), blocks_[to].data());
      }
    }
  }
  return is_definite;
}

void BlockCholesky::solve(Vector& v) {
  const auto of = [&](int i) {
    return Eigen::Map<Column>(permuted_.data() + kWidth * at_[static_cast<std::size_t>(i)]);
  };
  for (int i = 0; i < size(); ++i) of(i) = v.col(i);
  if (size() == 0) return;
  const double* blocks = blocks_.front().data();
  const double* inverses = diagonal(0).data();
  solve_forward(size(), begins_.data(), rows_.data(), blocks, inverses, permuted_.data());
  solve_backward(size(), begins_.data(), rows_.data(), blocks, inverses, permuted_.data());
  for (int i = 0; i < size(); ++i) v.col(i) = of(i);
}

}  // namespace pliant
