#include "pliant/models/reduced/reduced_vertices.h"

#include <algorithm>

#include "pliant/core/parallel.h"

namespace pliant {
namespace {

constexpr int kBlock = 256;  // vertices

int blocks(int vertices) { return (vertices + kBlock - 1) / kBlock; }

}  // namespace

ReducedVertices::ReducedVertices(const ReducedModel& model)
    : rest_(model.mesh.vertices),
      rows_(model.basis.transpose()),
      parts_(model.rank(), blocks(static_cast<int>(model.mesh.vertices.cols()))) {}

void ReducedVertices::place(const Eigen::Isometry3d& world_from_body) {
  const Eigen::Matrix3d rotation = world_from_body.linear();
  rest_ = (rotation * rest_).colwise() + world_from_body.translation();
  for (int i = 0; i < size(); ++i) {
    rows_.middleCols<3>(3 * i) = (rows_.middleCols<3>(3 * i) * rotation.transpose()).eval();
  }
}

void ReducedVertices::apply(const Eigen::VectorXd& coordinates, const Eigen::Matrix3Xd* offset,
                            Eigen::Matrix3Xd& result) const {
  result.resize(3, size());
  parallel_for(0, size(), kBlock, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      result.col(i) = rows_.middleCols<3>(3 * i).transpose().lazyProduct(coordinates);
      if (offset != nullptr) result.col(i) += offset->col(i);
    }
  });
}

void ReducedVertices::positions(const Eigen::VectorXd& q, Positions& x) const {
  apply(q, &rest_, x);
}

void ReducedVertices::velocities(const Eigen::VectorXd& p, Eigen::Matrix3Xd& v) const {
  apply(p, nullptr, v);
}

void ReducedVertices::reduce(const Forces& forces, Eigen::VectorXd& reduced) {
  const int count = blocks(size());
  // Blocks are cut the same way for any number of threads, and their sums are added in order.
  parallel_for(0, count, 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      auto sum = parts_.col(b);
      sum.setZero();
      const int last = std::min(size(), (b + 1) * kBlock);
      for (int i = b * kBlock; i < last; ++i) {
        for (int axis = 0; axis < 3; ++axis) sum += forces(axis, i) * rows_.col(3 * i + axis);
      }
    }
  });
  reduced.setZero(rank());
  for (int b = 0; b < count; ++b) reduced += parts_.col(b);
}

void ReducedVertices::rows_of(const CarriedPoints& points, int point,
                              Eigen::Ref<Eigen::MatrixXd> rows) const {
  rows.setZero();
  for (int k = 0; k < 4; ++k) {
    const int i = points.particles()(k, point);
    rows += points.weights()(k, point) * rows_.middleCols<3>(3 * i);
  }
}

}  // namespace pliant
