#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/solvers/linear/shared_stiffnesses.h"

namespace pliant {

/// A symmetric matrix of 3x3 blocks, n x n, whose rows and columns are particles. Blocks that are
/// only ever multiples s of the identity are kept as the scalar s: that is so where two vertices of
/// a cloth bend together and share no triangle, and these are most of the blocks of a sheet. What
/// many particles share, as those of a cluster, is no entry at all. The matrix keeps its pattern
/// from one assembly to the next, so that assembling anew allocates nothing.
class BlockMatrix final : public StiffnessMatrix {
 public:
  /// Begins an assembly: blocks of `inertia` [N/m] on the diagonal, and nothing else. Rows and
  /// columns of pinned particles stay those of the identity times their inertia.
  void begin(const Particles& particles, const Eigen::VectorXd& inertia);
  void add(int row, int column, const Eigen::Matrix3d& block) override;
  void add_isotropic(int row, int column, double stiffness) override;
  void add_shared(const SharedStiffness& shared) override;
  /// Ends it. False: there were blocks that the pattern had no place for; it has now, and all of
  /// the assembly has to be done again.
  bool finish();

  int size() const { return blocks_at_.rows(); }
  /// Blocks and scalars.
  int entries() const { return blocks_at_.size() + scalars(); }
  int scalars() const { return scalars_at_.size(); }
  /// Multiplications of a product with a vector.
  double work() const;
  /// What is in no entry.
  const SharedStiffnesses& shared() const { return shared_; }
  Eigen::Matrix3d diagonal(int row) const {
    return blocks_[static_cast<std::size_t>(diagonals_[static_cast<std::size_t>(row)])] +
           shared_.diagonal(row);
  }
  /// `use(column)` for each entry of a row, in ascending order, until it returns false.
  template <class Use>
  void for_columns(int row, const Use& use) const;
  /// `use(column, block)` for each entry of a row.
  template <class Use>
  void for_blocks(int row, const Use& use) const;
  /// `use_block(column, block)` for each block of a row, then `use_scalar(column, scalar)` for each
  /// scalar.
  template <class UseBlock, class UseScalar>
  void for_entries(int row, const UseBlock& use_block, const UseScalar& use_scalar) const;
  /// y = A v, both 3 x n.
  void multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const;

 private:
  using Places = std::vector<std::pair<int, int>>;  // rows and columns
  /// Columns of each row, in order.
  struct Pattern {
    std::vector<int> begins = {0}, columns;
    int rows() const { return static_cast<int>(begins.size()) - 1; }
    int size() const { return static_cast<int>(columns.size()); }
    int begin(int row) const { return begins[static_cast<std::size_t>(row)]; }
    int end(int row) const { return begins[static_cast<std::size_t>(row) + 1]; }
    int column(int entry) const { return columns[static_cast<std::size_t>(entry)]; }
    bool is_at(int entry, int row, int of) const {
      return entry >= begin(row) && entry < end(row) && column(entry) == of;
    }
    int find(int row, int of) const;  ///< -1: it has none
    void append_to(Places& places) const;
    /// Of `rows` rows; sorts the places.
    void take(int rows, Places& places);
  };
  void widen_pattern();

  const Particles* particles_ = nullptr;  // of the running assembly
  Pattern blocks_at_, scalars_at_;        // no place is in both
  std::vector<int> diagonals_;
  std::vector<Eigen::Matrix3d> blocks_;  // and one more, which products read beyond the last
  std::vector<double> scalars_;          // [N/m]
  SharedStiffnesses shared_;
  // Where each block of an assembly went, in the order of add() and add_isotropic(): an entry of
  // blocks, or the complement of one of scalars.
  std::vector<int> found_;
  std::size_t added_ = 0;                // of the running assembly
  Places stray_blocks_, stray_scalars_;  // that the pattern lacks
};

template <class Use>
void BlockMatrix::for_columns(int row, const Use& use) const {
  int b = blocks_at_.begin(row), s = scalars_at_.begin(row);
  const int blocks = blocks_at_.end(row), scalars = scalars_at_.end(row);
  while (b < blocks || s < scalars) {
    const bool is_block =
        s == scalars || (b < blocks && blocks_at_.column(b) < scalars_at_.column(s));
    if (!use(is_block ? blocks_at_.column(b++) : scalars_at_.column(s++))) return;
  }
}

template <class UseBlock, class UseScalar>
void BlockMatrix::for_entries(int row, const UseBlock& use_block,
                              const UseScalar& use_scalar) const {
  for (int e = blocks_at_.begin(row); e < blocks_at_.end(row); ++e) {
    use_block(blocks_at_.column(e), blocks_[static_cast<std::size_t>(e)]);
  }
  for (int e = scalars_at_.begin(row); e < scalars_at_.end(row); ++e) {
    use_scalar(scalars_at_.column(e), scalars_[static_cast<std::size_t>(e)]);
  }
}

template <class Use>
void BlockMatrix::for_blocks(int row, const Use& use) const {
  for_entries(row, use, [&](int column, double scalar) {
    const Eigen::Matrix3d block = scalar * Eigen::Matrix3d::Identity();
    use(column, block);
  });
}

}  // namespace pliant
