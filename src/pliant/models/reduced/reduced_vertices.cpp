#include "pliant/models/reduced/reduced_vertices.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kBlock = 256;  // vertices

/// sum[k] += Σ_j columns[j * stride + k] factors[j], for k < size, in the order of the columns
/// whatever the width. Four columns at a time.
PLIANT_WIDEST void add_columns(const double* columns, Eigen::Index stride, const double* factors,
                               int count, int size, double* __restrict sum) {
  int j = 0;
  for (; j + 4 <= count; j += 4) {
    const double *c0 = columns + j * stride, *c1 = c0 + stride, *c2 = c1 + stride,
                 *c3 = c2 + stride;
    const double f0 = factors[j], f1 = factors[j + 1], f2 = factors[j + 2], f3 = factors[j + 3];
    for (int k = 0; k < size; ++k) {
      sum[k] = (((sum[k] + c0[k] * f0) + c1[k] * f1) + c2[k] * f2) + c3[k] * f3;
    }
  }
  for (; j < count; ++j) {
    const double* column = columns + j * stride;
    for (int k = 0; k < size; ++k) sum[k] += column[k] * factors[j];
  }
}

int blocks(int vertices) { return (vertices + kBlock - 1) / kBlock; }

}  // namespace

ReducedVertices::ReducedVertices(const ReducedModel& model)
    : rest_(model.mesh.vertices),
      columns_(model.basis),
      rows_(model.basis.transpose()),
      parts_(model.rank(), blocks(static_cast<int>(model.mesh.vertices.cols()))) {}

void ReducedVertices::place(const Eigen::Isometry3d& world_from_body) {
  const Eigen::Matrix3d rotation = world_from_body.linear();
  rest_ = (rotation * rest_).colwise() + world_from_body.translation();
  for (int i = 0; i < size(); ++i) {
    rows_.middleCols<3>(3 * i) = (rows_.middleCols<3>(3 * i) * rotation.transpose()).eval();
  }
  columns_ = rows_.transpose();
}

void ReducedVertices::apply(const Eigen::VectorXd& coordinates, const Eigen::Matrix3Xd* offset,
                            Eigen::Matrix3Xd& result) const {
  result.resize(3, size());
  parallel_for(0, size(), kBlock, [&](int begin, int end) {
    if (offset != nullptr) {
      result.middleCols(begin, end - begin) = offset->middleCols(begin, end - begin);
    } else {
      result.middleCols(begin, end - begin).setZero();
    }
    add_columns(columns_.data() + 3 * begin, columns_.rows(), coordinates.data(), rank(),
                3 * (end - begin), result.data() + 3 * begin);
  });
}

void ReducedVertices::positions(const Eigen::VectorXd& q, Positions& x) const {
  apply(q, &rest_, x);
}

void ReducedVertices::velocities(const Eigen::VectorXd& p, Eigen::Matrix3Xd& v) const {
  apply(p, nullptr, v);
}

void ReducedVertices::reduce(const Forces& forces, Eigen::VectorXd& reduced) {
  if (forces.isZero(0.0)) {
    reduced.setZero(rank());
    return;
  }
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

void ReducedVertices::rows_of(const EmbeddedPoints& points, int point,
                              Eigen::Ref<Eigen::MatrixXd> rows) const {
  rows.setZero();
  for (int k = 0; k < 4; ++k) {
    const int i = points.particles()(k, point);
    rows += points.weights()(k, point) * rows_.middleCols<3>(3 * i);
  }
}

}  // namespace pliant
