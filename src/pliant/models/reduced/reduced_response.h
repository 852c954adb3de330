#pragma once

#include <Eigen/Core>

#include "pliant/models/reduced/reduced_system.h"

namespace pliant {

/// What a force on the coordinates, constant during a step, does to q and p by the step's end: of a
/// free body coordinate by coordinate, of one that attachments hold by full matrices.
class ReducedResponse {
 public:
  explicit ReducedResponse(const StepResponse& free) : free_(free) {}
  ReducedResponse(const StepResponse& free, const Eigen::MatrixXd& q, const Eigen::MatrixXd& p)
      : free_(free), q_(&q), p_(&p) {}

  /// `result` = C forces, each a column.
  template <class Force, class Result>
  void to_q(const Force& forces, Result&& result) const {
    if (q_ == nullptr) {
      result = free_.q.asDiagonal() * forces;
    } else {
      result.noalias() = q_->lazyProduct(forces);
    }
  }
  template <class Force, class Result>
  void to_p(const Force& forces, Result&& result) const {
    if (p_ == nullptr) {
      result = free_.p.asDiagonal() * forces;
    } else {
      result.noalias() = p_->lazyProduct(forces);
    }
  }

 private:
  const StepResponse& free_;
  const Eigen::MatrixXd* q_ = nullptr;
  const Eigen::MatrixXd* p_ = nullptr;
};

}  // namespace pliant
