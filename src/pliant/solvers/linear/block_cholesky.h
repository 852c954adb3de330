#pragma once

#include <Eigen/Core>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace pliant {

/// A = L Lᵀ of a sparse symmetric matrix of N x N blocks. The pattern is analysed once; factoring
/// other values with it allocates nothing. Unknowns without stiffness of their own, as a turn of
/// particles on one line about it, are left out: their solution is 0.
template <int N>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, Eigen::Dynamic>;

  /// The pattern: pairs (row, column) of blocks, either triangle, in any order.
  void analyze(int size, const std::vector<std::pair<int, int>>& pairs);
  /// Begins a matrix of that pattern: all blocks are 0.
  void begin() {
    for (Block& block : blocks_) block.setZero();
  }
  /// Adds to block (row, column) and, where these differ, its transpose to (column, row). That
  /// block has to be in the pattern.
  void add(int row, int column, const Block& block);
  void factor();
  /// v <- A⁻¹ v, N x size.
  void solve(Vector& v);

  int size() const { return static_cast<int>(diagonals_.size()); }
  /// Blocks of L below its diagonal.
  int nonzeros() const { return static_cast<int>(rows_.size()); }

 private:
  // Of what a pivot was: what is left of one that is none.
  static constexpr double kNone = 1e-10;

  std::size_t place(int row, int column) const {
    const auto first = rows_.begin() + begins_[static_cast<std::size_t>(column)];
    const auto last = rows_.begin() + begins_[static_cast<std::size_t>(column) + 1];
    return static_cast<std::size_t>(std::lower_bound(first, last, row) - rows_.begin());
  }
  static void factor_block(const Eigen::Matrix<double, N, 1>& was, Block& block);

  std::vector<int> at_;             // a row of A's place in L
  std::vector<int> begins_, rows_;  // of each column of L below its diagonal
  std::vector<Block> blocks_;       // those of rows_, then the diagonal ones
  std::vector<std::size_t> diagonals_;
  std::vector<Eigen::Matrix<double, N, 1>> was_;  // diagonals of A
  Vector permuted_;
};

template <int N>
void BlockCholesky<N>::analyze(int size, const std::vector<std::pair<int, int>>& pairs) {
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
  blocks_.assign(rows_.size() + static_cast<std::size_t>(size), Block::Zero());
  diagonals_.resize(static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < diagonals_.size(); ++i) diagonals_[i] = rows_.size() + i;
  was_.resize(static_cast<std::size_t>(size));
  permuted_.resize(N, size);
}

template <int N>
void BlockCholesky<N>::add(int row, int column, const Block& block) {
  const int a = at_[static_cast<std::size_t>(row)], b = at_[static_cast<std::size_t>(column)];
  if (a == b) {
    blocks_[diagonals_[static_cast<std::size_t>(a)]] += block;
  } else if (a > b) {
    blocks_[place(a, b)] += block;
  } else {
    blocks_[place(b, a)] += block.transpose();
  }
}

template <int N>
void BlockCholesky<N>::factor_block(const Eigen::Matrix<double, N, 1>& was, Block& block) {
  for (int k = 0; k < N; ++k) {
    double pivot = block(k, k);
    for (int c = 0; c < k; ++c) pivot -= block(k, c) * block(k, c);
    // An unknown without stiffness is held by one beyond all others.
    const bool is_none = !(pivot > kNone * was[k]);
    block(k, k) = is_none ? 1e150 : std::sqrt(pivot);
    for (int r = k + 1; r < N; ++r) {
      double value = block(r, k);
      for (int c = 0; c < k; ++c) value -= block(r, c) * block(k, c);
      block(r, k) = is_none ? 0.0 : value / block(k, k);
    }
  }
}

template <int N>
void BlockCholesky<N>::factor() {
  for (std::size_t j = 0; j < diagonals_.size(); ++j) was_[j] = blocks_[diagonals_[j]].diagonal();
  for (std::size_t j = 0; j < diagonals_.size(); ++j) {
    Block& diagonal = blocks_[diagonals_[j]];
    factor_block(was_[j], diagonal);
    const auto first = static_cast<std::size_t>(begins_[j]);
    const auto last = static_cast<std::size_t>(begins_[j + 1]);
    for (std::size_t e = first; e < last; ++e) {
      // L_ij = A_ij L_jj⁻ᵀ
      Block transposed = blocks_[e].transpose();
      diagonal.template triangularView<Eigen::Lower>().solveInPlace(transposed);
      blocks_[e] = transposed.transpose();
    }
    for (std::size_t e = first; e < last; ++e) {
      const auto k = static_cast<std::size_t>(rows_[e]);
      blocks_[diagonals_[k]].noalias() -= blocks_[e] * blocks_[e].transpose();
      auto to = static_cast<std::size_t>(begins_[k]);
      for (std::size_t f = e + 1; f < last; ++f) {
        while (rows_[to] < rows_[f]) ++to;
        blocks_[to].noalias() -= blocks_[f] * blocks_[e].transpose();
      }
    }
  }
}

template <int N>
void BlockCholesky<N>::solve(Vector& v) {
  using Column = Eigen::Matrix<double, N, 1>;
  for (int i = 0; i < size(); ++i) permuted_.col(at_[static_cast<std::size_t>(i)]) = v.col(i);
  for (int j = 0; j < size(); ++j) {
    const auto column = static_cast<std::size_t>(j);
    Column x = permuted_.col(j);
    blocks_[diagonals_[column]].template triangularView<Eigen::Lower>().solveInPlace(x);
    permuted_.col(j) = x;
    for (int e = begins_[column]; e < begins_[column + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      permuted_.col(rows_[entry]).noalias() -= blocks_[entry] * x;
    }
  }
  for (int j = size() - 1; j >= 0; --j) {
    const auto column = static_cast<std::size_t>(j);
    Column x = permuted_.col(j);
    for (int e = begins_[column]; e < begins_[column + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      x.noalias() -= blocks_[entry].transpose() * permuted_.col(rows_[entry]);
    }
    blocks_[diagonals_[column]].template triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    permuted_.col(j) = x;
  }
  for (int i = 0; i < size(); ++i) v.col(i) = permuted_.col(at_[static_cast<std::size_t>(i)]);
}

}  // namespace pliant
