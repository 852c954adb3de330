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

  void clear() {
    entries_.clear();
    stiffness_.clear();
    begins_.assign(1, 0);
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

  int size() const { return static_cast<int>(stiffness_.size()); }
  double stiffness(int row) const { return stiffness_[static_cast<std::size_t>(row)]; }
  const Entry* begin(int row) const { return entries_.data() + begin_of(row); }
  const Entry* end(int row) const { return entries_.data() + begin_of(row + 1); }
  int entries(int row) const { return static_cast<int>(begin_of(row + 1) - begin_of(row)); }

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
  void add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& f) const {
    for (int row = 0; row < size(); ++row) add_scaled(row, stiffness(row) * along(row, v), f);
  }
  /// f += Jᵀ scale of one row.
  void add_scaled(int row, double scale, Eigen::Matrix3Xd& f) const {
    for (const Entry* e = begin(row); e != end(row); ++e) f.col(e->particle) += scale * e->gradient;
  }

 private:
  std::size_t begin_of(int row) const { return begins_[static_cast<std::size_t>(row)]; }

  std::vector<Entry> entries_;
  std::vector<double> stiffness_;
  std::vector<std::size_t> begins_ = {0};
};

}  // namespace pliant
