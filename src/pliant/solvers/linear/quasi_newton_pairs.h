#pragma once

#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// How positions and forces changed in the last iterations of a step. L-BFGS makes an inverse
/// Hessian H of these pairs and of an inverse A⁻¹, by the two-loop recursion (Nocedal and Wright
/// 2006, algorithm 7.4).
class QuasiNewtonPairs {
 public:
  struct Pair {
    Positions s;     ///< change of positions [m]
    Forces y;        ///< change of the objective's gradient [N]
    Positions z;     ///< A⁻¹ y [m]; of no columns until somebody asked for it
    double inverse;  ///< 1 / (s . y) [1/J]
  };

  explicit QuasiNewtonPairs(int capacity)
      : pairs_(static_cast<std::size_t>(capacity)), alphas_(static_cast<std::size_t>(capacity)) {}

  void clear();
  int size() const { return held_; }
  /// The k-th newest.
  Pair& newest(int k) { return pairs_[place(k)]; }
  const Pair& newest(int k) const { return pairs_[place(k)]; }
  /// Where the next pair is filled in, before add_next(): the place of the oldest one.
  Pair& next() { return pairs_[static_cast<std::size_t>(next_)]; }
  /// Adds that pair, unless it has no curvature and says nothing of the Hessian.
  void add_next();

  /// v <- H v.
  template <class Inverse>
  void apply(const Inverse& a_inverse, Eigen::Matrix3Xd& v);

 private:
  static double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b);
  static void add(double scale, const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& a);
  std::size_t place(int k) const {
    const int capacity = static_cast<int>(pairs_.size());
    return static_cast<std::size_t>((next_ - 1 - k + 2 * capacity) % capacity);
  }

  std::vector<Pair> pairs_;  // a ring, its oldest entry at next_ once it is full
  int held_ = 0;
  int next_ = 0;
  std::vector<double> alphas_;
};

template <class Inverse>
void QuasiNewtonPairs::apply(const Inverse& a_inverse, Eigen::Matrix3Xd& v) {
  for (int k = 0; k < held_; ++k) {
    const Pair& pair = newest(k);
    const double alpha = pair.inverse * dot(pair.s, v);
    alphas_[static_cast<std::size_t>(k)] = alpha;
    add(-alpha, pair.y, v);
  }
  a_inverse(v);
  for (int k = held_ - 1; k >= 0; --k) {
    const Pair& pair = newest(k);
    add(alphas_[static_cast<std::size_t>(k)] - pair.inverse * dot(pair.y, v), pair.s, v);
  }
}

}  // namespace pliant
