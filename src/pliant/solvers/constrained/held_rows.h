#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Directions J of displacements that springs of stiffness K hold: a term Jᵀ K J of a matrix.
/// Reused, so that it allocates nothing once it is warm.
class HeldRows {
 public:
  struct Entry {
    int particle;
    Eigen::Vector3d gradient;
  };
  /// Some rows that hold the same particles, as one matrix between these.
  struct Block {
    int first, last;  ///< rows, the last one not among them
    int particles;    ///< how many
    std::size_t stiffnesses;

    std::size_t of(int a, int b) const {
      return stiffnesses + static_cast<std::size_t>(a * particles + b);
    }
  };

  void clear() {
    entries_.clear();
    stiffness_.clear();
    begins_.assign(1, 0);
    blocks_.clear();
    stiffnesses_.clear();
  }
  /// Begins a row of `stiffness` [N/m] for gradients without unit.
  void begin_row(double stiffness) {
    stiffness_.push_back(stiffness);
    begins_.push_back(begins_.back());
  }
  /// Takes memory for as many more entries, and for some more than these.
  void reserve_more(std::size_t entries) {
    const std::size_t wanted = entries_.size() + entries;
    if (entries_.capacity() < wanted) entries_.reserve(2 * wanted);
  }
  void add(int particle, const Eigen::Vector3d& gradient) {
    entries_.push_back({particle, gradient});
    ++begins_.back();
  }
  /// Makes blocks of rows that follow one another and hold the same particles, where products with
  /// them take less work: those of all points of a rigid body that touch, and the three of a vertex
  /// that sticks. After the last row was added.
  void merge();

  int size() const { return static_cast<int>(stiffness_.size()); }
  double stiffness(int row) const { return stiffness_[static_cast<std::size_t>(row)]; }
  const Entry* begin(int row) const { return entries_.data() + begin_of(row); }
  const Entry* end(int row) const { return entries_.data() + begin_of(row + 1); }
  int entries(int row) const { return static_cast<int>(begin_of(row + 1) - begin_of(row)); }

  /// Calls of_row(row) for each row that is in no block, and of_block(block) for each block, in the
  /// order of their rows.
  template <class OfRow, class OfBlock>
  void for_each(const OfRow& of_row, const OfBlock& of_block) const {
    int row = 0;
    for (const Block& block : blocks_) {
      for (; row < block.first; ++row) of_row(row);
      of_block(block);
      row = block.last;
    }
    for (; row < size(); ++row) of_row(row);
  }
  int particle(const Block& block, int number) const { return begin(block.first)[number].particle; }
  /// Of the force on the particle with the number `a` in a block, by a displacement of the one with
  /// the number `b` [N/m].
  const Eigen::Matrix3d& stiffness(const Block& block, int a, int b) const {
    return stiffnesses_[block.of(a, b)];
  }

  /// The displacements `v` along a row's direction [m].
  double along(int row, const Eigen::Matrix3Xd& v) const {
    double sum = 0.0;
    for (const Entry* e = begin(row); e != end(row); ++e)
      sum += e->gradient.dot(v.col(e->particle));
    return sum;
  }
  /// f += Jᵀ K u, u [m] of each row.
  void add_force(const Eigen::VectorXd& u, Eigen::Matrix3Xd& f) const {
    for (int row = 0; row < size(); ++row) add_scaled(row, stiffness(row) * u[row], f);
  }
  /// f += Jᵀ K J v.
  void add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& f) const;
  /// f += Jᵀ scale of one row.
  void add_scaled(int row, double scale, Eigen::Matrix3Xd& f) const {
    for (const Entry* e = begin(row); e != end(row); ++e) f.col(e->particle) += scale * e->gradient;
  }
  /// Each particle's own block of Jᵀ K J, to that of `diagonal`.
  void add_diagonal(std::vector<Eigen::Matrix3d>& diagonal) const;

 private:
  std::size_t begin_of(int row) const { return begins_[static_cast<std::size_t>(row)]; }
  bool hold_the_same(int row, int other) const;
  void append_block(int first, int last);

  std::vector<Entry> entries_;
  std::vector<double> stiffness_;
  std::vector<std::size_t> begins_ = {0};
  std::vector<Block> blocks_;
  std::vector<Eigen::Matrix3d> stiffnesses_;
};

}  // namespace pliant
