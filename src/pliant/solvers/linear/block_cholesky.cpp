#include "pliant/solvers/linear/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <cmath>
#include <cstring>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/widest.h"
#include "pliant/solvers/linear/elimination_tree.h"

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

/// Writes the columns of a block. In this order each overwrites what the one before it left there;
/// behind the last one is another block.
inline __attribute__((always_inline)) void write(const Wide (&columns)[kSize], double* block) {
  for (int c = 0; c + 1 < kSize; ++c) {
    std::memcpy(block + kSize * c, &columns[c], sizeof columns[c]);
  }
  const int last = kSize - 1;
  for (int r = 0; r < kSize; ++r) block[kSize * last + r] = columns[last][r];
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
  write(product, b);
}

/// c −= a bᵀ.
PLIANT_WIDEST void take_product(const double* a, const double* b, double* c) {
  Wide sums[kSize];
  for (int j = 0; j < kSize; ++j) std::memcpy(&sums[j], c + kSize * j, sizeof sums[j]);
  for (int k = 0; k < kSize; ++k) {
    Wide column;
    std::memcpy(&column, a + kSize * k, sizeof column);
    for (int j = 0; j < kSize; ++j) sums[j] -= column * b[kSize * k + j];
  }
  write(sums, c);
}

/// Of a factor with its columns below their diagonals: where these begin, where their rows come
/// after both groups, and their rows.
struct Pattern {
  const int *begins, *ends, *rows;
};

/// L x = v of the columns [first, last), in place; `v` holds kWidth numbers a row of blocks, and
/// `after` those of rows after both groups, from the row number `first_after` on.
PLIANT_WIDEST void solve_forward(int first, int last, const Pattern& pattern, const double* blocks,
                                 const double* inverses, double* v, double* after,
                                 int first_after) {
  const int* rows = pattern.rows;
  for (int j = first; j < last; ++j) {
    double* at = v + kWidth * j;
    Wide x = Wide{};
    for (int k = 0; k < kSize; ++k) {
      Wide column;
      std::memcpy(&column, inverses + kEntries * j + kSize * k, sizeof column);
      x += column * at[k];
    }
    std::memcpy(at, &x, sizeof x);
    for (int e = pattern.begins[j]; e < pattern.begins[j + 1]; ++e) {
      const double* block = blocks + static_cast<std::ptrdiff_t>(kEntries) * e;
      double* to =
          e < pattern.ends[j] ? v + kWidth * rows[e] : after + kWidth * (rows[e] - first_after);
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

/// Lᵀ x = v of the columns from the last one on, in place.
PLIANT_WIDEST void solve_backward(int first, int last, const Pattern& pattern, const double* blocks,
                                  const double* inverses, double* v) {
  for (int j = last - 1; j >= first; --j) {
    double* at = v + kWidth * j;
    Wide products[kSize] = {};
    for (int e = pattern.begins[j]; e < pattern.begins[j + 1]; ++e) {
      const double* block = blocks + static_cast<std::ptrdiff_t>(kEntries) * e;
      Wide x;
      std::memcpy(&x, v + kWidth * pattern.rows[e], sizeof x);
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

void BlockCholesky::find_pattern(int size, const std::vector<std::pair<int, int>>& pairs,
                                 std::vector<std::vector<int>>& columns) {
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
  columns.assign(static_cast<std::size_t>(size), {});
  for (int j = 0; j < size; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(pattern, j); entry; ++entry) {
      const int a = at_[static_cast<std::size_t>(entry.row())];
      const int b = at_[static_cast<std::size_t>(j)];
      if (a > b) columns[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  // A column's rows go on in the column of the first of them.
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    if (column.size() > 1) {
      auto& parent = columns[static_cast<std::size_t>(column.front())];
      parent.insert(parent.end(), column.begin() + 1, column.end());
    }
  }
}

void BlockCholesky::split(std::vector<std::vector<int>>& columns) {
  const EliminationTree tree(columns);
  const EliminationTree::Groups groups = tree.split();
  groups_[0] = {0, groups.first};
  groups_[1] = {groups.first, groups.second};
  after_ = groups.second;
  for (int& at : at_) at = groups.number_of[static_cast<std::size_t>(at)];
  std::vector<std::vector<int>> renumbered(columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j) {
    auto& column = renumbered[static_cast<std::size_t>(groups.number_of[j])];
    for (const int row : columns[j]) {
      column.push_back(groups.number_of[static_cast<std::size_t>(row)]);
    }
    std::sort(column.begin(), column.end());
  }
  columns.swap(renumbered);
}

void BlockCholesky::analyze(int size, const std::vector<std::pair<int, int>>& pairs) {
  std::vector<std::vector<int>> columns;
  find_pattern(size, pairs, columns);
  split(columns);
  begins_ = {0};
  rows_.clear();
  ends_.clear();
  for (const auto& column : columns) {
    const bool is_after = static_cast<int>(ends_.size()) >= after_;
    const auto end =
        is_after ? column.end() : std::lower_bound(column.begin(), column.end(), after_);
    ends_.push_back(begins_.back() + static_cast<int>(end - column.begin()));
    rows_.insert(rows_.end(), column.begin(), column.end());
    begins_.push_back(static_cast<int>(rows_.size()));
  }
  blocks_.assign(rows_.size() + static_cast<std::size_t>(size) + 1, Block::Zero());
  was_.resize(static_cast<std::size_t>(size));
  permuted_.assign(static_cast<std::size_t>(kWidth * size), 0.0);
  const auto last = static_cast<std::size_t>(size - after_);
  taken_.assign(kWidth * last, 0.0);
  taken_blocks_.assign(rows_.size() - static_cast<std::size_t>(begins_[after_]) + last + 1,
                       Block::Zero());
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

bool BlockCholesky::factor_columns(Range range, Block* blocks_after, Block* diagonals_after) {
  bool is_definite = true;
  const int first_after = begins_[static_cast<std::size_t>(after_)];
  for (int j = range.first; j < range.last; ++j) {
    const auto column = static_cast<std::size_t>(j);
    is_definite &= invert_factor(was_[column], diagonal(j));
    const int first = begins_[column], last = begins_[column + 1];
    // L_ij = A_ij L_jj⁻ᵀ
    for (int e = first; e < last; ++e) {
      divide_by_factor(diagonal(j).data(), blocks_[static_cast<std::size_t>(e)].data());
    }
    for (int e = first; e < last; ++e) {
      const int k = rows_[static_cast<std::size_t>(e)];
      const bool is_after = k >= after_;
      Block& own = is_after ? diagonals_after[k - after_] : diagonal(k);
      const double* by = blocks_[static_cast<std::size_t>(e)].data();
      take_product(by, by, own.data());
      int to = begins_[static_cast<std::size_t>(k)];
      for (int f = e + 1; f < last; ++f) {
        while (rows_[static_cast<std::size_t>(to)] < rows_[static_cast<std::size_t>(f)]) ++to;
        Block& other =
            is_after ? blocks_after[to - first_after] : blocks_[static_cast<std::size_t>(to)];
        take_product(blocks_[static_cast<std::size_t>(f)].data(), by, other.data());
      }
    }
  }
  return is_definite;
}

template <class Use>
void BlockCholesky::for_groups(const Use& use) {
  if (!is_split()) {
    use(0);
    return;
  }
  parallel_for(0, 2, 1, [&](int begin, int end) {
    for (int group = begin; group < end; ++group) use(group);
  });
}

bool BlockCholesky::factor() {
  if (size() == 0) return true;
  for (int j = 0; j < size(); ++j) was_[static_cast<std::size_t>(j)] = diagonal(j).diagonal();
  const auto below = static_cast<std::size_t>(begins_[static_cast<std::size_t>(after_)]);
  Block* const own_blocks = blocks_.data() + below;
  Block* const own_diagonals = &blocks_[rows_.size() + static_cast<std::size_t>(after_)];
  const std::size_t blocks = rows_.size() - below;
  Block* const taken = taken_blocks_.data();
  bool are_definite[2] = {true, true};
  for_groups([&](int group) {
    if (group == 0) {
      are_definite[0] = factor_columns(groups_[0], own_blocks, own_diagonals);
      return;
    }
    for (Block& block : taken_blocks_) block.setZero();
    are_definite[1] = factor_columns(groups_[1], taken, taken + blocks);
  });
  if (is_split()) {
    for (std::size_t k = 0; k < blocks; ++k) own_blocks[k] += taken[k];
    for (int k = 0; k < size() - after_; ++k) own_diagonals[k] += taken[blocks + std::size_t(k)];
  }
  const bool is_definite = factor_columns({after_, size()}, own_blocks, own_diagonals);
  return are_definite[0] && are_definite[1] && is_definite;
}

void BlockCholesky::solve_groups() {
  const Pattern pattern = {begins_.data(), ends_.data(), rows_.data()};
  const double* blocks = blocks_.front().data();
  const double* inverses = diagonal(0).data();
  double* const v = permuted_.data();
  double* const after = v + kWidth * after_;
  for_groups([&](int group) {
    const Range range = groups_[group];
    if (group > 0) std::fill(taken_.begin(), taken_.end(), 0.0);
    solve_forward(range.first, range.last, pattern, blocks, inverses, v,
                  group > 0 ? taken_.data() : after, after_);
  });
  if (is_split()) {
    for (std::size_t k = 0; k < taken_.size(); ++k) after[k] += taken_[k];
  }
  solve_forward(after_, size(), pattern, blocks, inverses, v, after, after_);
  solve_backward(after_, size(), pattern, blocks, inverses, v);
  for_groups([&](int group) {
    solve_backward(groups_[group].first, groups_[group].last, pattern, blocks, inverses, v);
  });
}

void BlockCholesky::solve(Vector& v) {
  const auto of = [&](int i) {
    return Eigen::Map<Column>(permuted_.data() + kWidth * at_[static_cast<std::size_t>(i)]);
  };
  for (int i = 0; i < size(); ++i) of(i) = v.col(i);
  if (size() == 0) return;
  solve_groups();
  for (int i = 0; i < size(); ++i) v.col(i) = of(i);
}

}  // namespace pliant
