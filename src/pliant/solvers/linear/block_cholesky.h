#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

namespace pliant {

/// A = L Lᵀ of a sparse symmetric matrix of 6x6 blocks. The pattern is analysed once; factoring
/// other values with it allocates nothing. Unknowns without stiffness of their own, as a turn of
/// particles on one line about it, are left out: their solution is 0.
///
/// Its columns are two groups of subtrees of the elimination tree, which know nothing of each other
/// and may have a thread each, and the columns that come after both. What a group leaves to these
/// is summed apart, so that results do not depend on threads.
class BlockCholesky {
 public:
  static constexpr int kSize = 6;  ///< rows and columns of a block
  using Block = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, Eigen::Dynamic>;

  /// The pattern: pairs (row, column) of blocks, either triangle, in any order.
  void analyze(int size, const std::vector<std::pair<int, int>>& pairs);
  /// Begins a matrix of that pattern: all blocks are 0.
  void begin() {
    for (Block& block : blocks_) block.setZero();
  }
  /// Adds to block (row, column) and, where these differ, its transpose to (column, row). That
  /// block has to be in the pattern.
  void add(int row, int column, const Block& block);
  /// False where the matrix is not positive definite: as if what stands in the way were held.
  bool factor();
  /// v <- A⁻¹ v, 6 x size.
  void solve(Vector& v);

  int size() const { return static_cast<int>(was_.size()); }
  /// Blocks of L below its diagonal.
  int nonzeros() const { return static_cast<int>(rows_.size()); }
  /// Products of blocks that a factor takes.
  double products() const;
  /// Whether there is a place for block (row, column).
  bool has(int row, int column) const;

 private:
  using Column = Eigen::Matrix<double, kSize, 1>;

  std::size_t place(int row, int column) const {
    const auto first = rows_.begin() + begins_[static_cast<std::size_t>(column)];
    const auto last = rows_.begin() + begins_[static_cast<std::size_t>(column) + 1];
    return static_cast<std::size_t>(std::lower_bound(first, last, row) - rows_.begin());
  }
  /// Columns [first, last) of a group, or of those after both.
  struct Range {
    int first = 0, last = 0;
  };
  void find_pattern(int size, const std::vector<std::pair<int, int>>& pairs,
                    std::vector<std::vector<int>>& columns);
  /// Gives the columns their groups and numbers.
  void split(std::vector<std::vector<int>>& columns);
  bool is_split() const { return groups_[1].first < groups_[1].last; }
  /// Calls use(group) for each group, in threads of their own.
  template <class Use>
  void for_groups(const Use& use);
  bool factor_columns(Range range, Block* blocks_after, Block* diagonals_after);
  void solve_groups();
  Block& diagonal(int i) { return blocks_[rows_.size() + static_cast<std::size_t>(i)]; }

  std::vector<int> at_;             // a row of A's place in L
  std::vector<int> begins_, rows_;  // of each column of L below its diagonal
  std::vector<int> ends_;           // of each column, the first of its rows after both groups
  Range groups_[2];
  int after_ = 0;  // the first column after both
  // Those of rows_, then the diagonal ones, which are inverted in the factor, and one more, which
  // wide registers read into beyond the last.
  std::vector<Block> blocks_;
  std::vector<Column> was_;       // diagonals of A
  std::vector<double> permuted_;  // kWidth numbers for each row of blocks
  // What the second group takes from the columns after both.
  std::vector<Block> taken_blocks_;
  std::vector<double> taken_;
};

}  // namespace pliant
