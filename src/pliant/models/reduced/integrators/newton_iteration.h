#pragma once

#include <Eigen/Core>
#include <cmath>

#include "pliant/math/dense_factors.h"

namespace pliant {

struct NewtonOptions {
  int iterations = 20;      ///< at most
  double tolerance = 1e-8;  ///< of |F| against its first value; 0 takes all iterations
};

struct NewtonOutcome {
  int iterations = 0;
  double residual = 0.0;  ///< the last |F| that was computed, against the first
  bool converged = false;
};

/// Solves F(x) = 0 of a few unknowns by Newton's method with a line search on |F|. `evaluate(x, f,
/// j)` computes F and its symmetric Jacobian. With one iteration, or tolerance 0, nothing is
/// computed only to judge the result.
class NewtonIteration {
 public:
  template <class Evaluate>
  NewtonOutcome solve(const Evaluate& evaluate, const NewtonOptions& options, Eigen::VectorXd& x) {
    NewtonOutcome outcome;
    evaluate(x, f_, j_);
    const double first = f_.norm();
    double norm = first;
    outcome.residual = 1.0;
    if (!(first > 0.0)) {
      outcome.converged = first == 0.0;
      return outcome;
    }
    while (outcome.iterations < options.iterations) {
      solve_linear();
      ++outcome.iterations;
      x_ = x;
      x += dx_;
      if (outcome.iterations == options.iterations && options.tolerance == 0.0) return outcome;
      evaluate(x, f_, j_);
      double share = 1.0;
      while (!(f_.norm() <= norm || norm <= options.tolerance * first) && share > kSmallestShare) {
        share *= 0.5;
        x = x_ + share * dx_;
        evaluate(x, f_, j_);
      }
      norm = f_.norm();
      outcome.residual = norm / first;
      // A step below round-off of x cannot be bettered.
      const bool is_stuck = dx_.norm() <= 4.0 * kRoundOff * x.norm();
      outcome.converged = norm <= options.tolerance * first || (is_stuck && std::isfinite(norm));
      if (outcome.converged || !std::isfinite(norm)) break;
    }
    return outcome;
  }

 private:
  static constexpr double kSmallestShare = 0.01;
  static constexpr double kRoundOff = 2.3e-16;

  void solve_linear() {
    if (factor_.compute(j_)) {
      dx_ = -f_;
      factor_.solve_in_place(dx_);
    } else {
      dx_ = solve_dense(j_, -f_);  // compressed so far that the tangent is indefinite
    }
  }

  Eigen::VectorXd f_, dx_, x_;
  Eigen::MatrixXd j_;
  DenseCholesky factor_;
};

}  // namespace pliant
