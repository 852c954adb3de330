#include "pliant/solvers/linear/pair_cholesky.h"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {
// Springs on more particles than these would fill the factor, and cost an iteration each if not.
constexpr int kLocal = 16;
constexpr double kBlock = BlockCholesky::kSize * BlockCholesky::kSize;
}  // namespace

void PairCholesky::prepare(const BlockMatrix& matrix) {
  const int n = matrix.size();
  places_.assign(static_cast<std::size_t>(n), {-1, 0});
  count_ = 0;
  singles_.clear();
  for (int i = 0; i < n; ++i) {
    if (of(i).pair >= 0) continue;
    places_[static_cast<std::size_t>(i)] = {count_, 0};
    int other = -1;
    matrix.for_columns(i, [&](int column) {
      if (of(column).pair < 0) other = column;
      return other < 0;
    });
    if (other >= 0) {
      places_[static_cast<std::size_t>(other)] = {count_, 3};
    } else {
      singles_.push_back(count_);
    }
    ++count_;
  }
  forget();
}

void PairCholesky::forget() {
  pattern_.clear();
  is_analyzed_ = has_next_ = false;
}

template <class F>
void PairCholesky::for_tied(const HeldRows& rows, const F& f) const {
  const auto of_row = [&](int row) {
    if (rows.entries(row) > kLocal) return;
    for (const auto* a = rows.begin(row); a != rows.end(row); ++a) {
      for (const auto* b = a + 1; b < rows.end(row); ++b) {
        const int p = of(a->particle).pair, q = of(b->particle).pair;
        if (p != q) f(p, q);
      }
    }
  };
  rows.for_each(of_row, [&](const HeldRows::Block& block) { of_row(block.first); });
}

void PairCholesky::analyze(const BlockMatrix& matrix, const HeldRows& rows) {
  const int blocks = matrix.entries();
  if (blocks != blocks_) forget();  // the matrix has got more of them
  blocks_ = blocks;
  const BlockCholesky& last = has_next_ ? next_ : factor_;
  bool has_all = is_analyzed_;
  if (has_all) for_tied(rows, [&](int p, int q) { has_all = has_all && last.has(p, q); });
  if (has_all) return;
  if (!is_analyzed_) {
    for (int i = 0; i < matrix.size(); ++i) {
      matrix.for_columns(i, [&](int column) {
        const int p = of(i).pair, q = of(column).pair;
        if (p < q) pattern_.emplace_back(p, q);
        return true;
      });
    }
  }
  // All of them: places that a factor filled by chance are gone in the next.
  for_tied(rows, [&](int p, int q) { pattern_.emplace_back(std::minmax(p, q)); });
  std::sort(pattern_.begin(), pattern_.end());
  pattern_.erase(std::unique(pattern_.begin(), pattern_.end()), pattern_.end());
  next_.analyze(count_, pattern_);
  work_of_factor_ = BlockCholesky::kSize * kBlock * next_.products();
  work_of_solve_ = kBlock * (2.0 * next_.nonzeros() + count_);
  is_analyzed_ = has_next_ = true;
}

void PairCholesky::add(int row, int column, const Eigen::Matrix3d& block) {
  const Place a = of(row), b = of(column);
  BlockCholesky::Block wide = BlockCholesky::Block::Zero();
  wide.block<3, 3>(a.first, b.first) = block;
  factor_.add(a.pair, b.pair, wide);
}

bool PairCholesky::factor(const BlockMatrix& matrix, const HeldRows& rows) {
  if (std::exchange(has_next_, false)) std::swap(factor_, next_);
  factor_.begin();
  for (int i = 0; i < matrix.size(); ++i) {
    matrix.for_blocks(i, [&](int j, const Eigen::Matrix3d& block) {
      // Between pairs one triangle, within a pair all of its block.
      if (of(j).pair <= of(i).pair) add(i, j, block);
    });
  }
  add_rows(rows);
  for (const int single : singles_) {
    BlockCholesky::Block rest = BlockCholesky::Block::Zero();
    rest.diagonal().tail<3>().setOnes();
    factor_.add(single, single, rest);
  }
  return factor_.factor();
}

void PairCholesky::add_rows(const HeldRows& rows) {
  const auto is_lower = [&](int row, int column) { return of(column).pair <= of(row).pair; };
  rows.for_each(
      [&](int row) {
        if (rows.entries(row) > kLocal) return;
        for (const auto* a = rows.begin(row); a != rows.end(row); ++a) {
          for (const auto* b = rows.begin(row); b != rows.end(row); ++b) {
            if (!is_lower(a->particle, b->particle)) continue;
            add(a->particle, b->particle,
                rows.stiffness(row) * a->gradient * b->gradient.transpose());
          }
        }
      },
      [&](const HeldRows::Block& block) {
        if (block.particles > kLocal) return;
        for (int a = 0; a < block.particles; ++a) {
          for (int b = 0; b < block.particles; ++b) {
            const int row = rows.particle(block, a), column = rows.particle(block, b);
            if (is_lower(row, column)) add(row, column, rows.stiffness(block, a, b));
          }
        }
      });
}

void PairCholesky::solve(const Eigen::Matrix3Xd& r, Eigen::Matrix3Xd& z) {
  const auto n = static_cast<int>(places_.size());
  // Second halves of pairs that have none stay zero.
  solution_.setZero(BlockCholesky::kSize, count_);
  for (int i = 0; i < n; ++i) solution_.col(of(i).pair).segment<3>(of(i).first) = r.col(i);
  factor_.solve(solution_);
  for (int i = 0; i < n; ++i) z.col(i) = solution_.col(of(i).pair).segment<3>(of(i).first);
}

}  // namespace pliant
