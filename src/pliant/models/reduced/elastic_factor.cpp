#include "pliant/models/reduced/elastic_factor.h"

#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/math/error.h"
#include "pliant/solvers/linear/block_matrix.h"

namespace pliant {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Adds the blocks of three columns of a matrix, one beside the other.
class BlocksOfVertex {
 public:
  explicit BlocksOfVertex(int vertices)
      : is_met_(static_cast<std::size_t>(vertices), false),
        blocks_(static_cast<std::size_t>(vertices)) {}

  void add(const Sparse& matrix, int vertex, BlockMatrix& blocks) {
    met_.clear();
    for (int axis = 0; axis < 3; ++axis) {
      for (Sparse::InnerIterator entry(matrix, 3 * vertex + axis); entry; ++entry) {
        const auto row = static_cast<std::size_t>(entry.row() / 3);
        if (!is_met_[row]) {
          is_met_[row] = true;
          met_.push_back(static_cast<int>(row));
          blocks_[row].setZero();
        }
        blocks_[row](entry.row() % 3, axis) = entry.value();
      }
    }
    for (const int row : met_) {
      is_met_[static_cast<std::size_t>(row)] = false;
      blocks.add(row, vertex, blocks_[static_cast<std::size_t>(row)]);
    }
  }

 private:
  std::vector<bool> is_met_;
  std::vector<int> met_;
  std::vector<Eigen::Matrix3d> blocks_;
};

void assemble(const Sparse& matrix, const Particles& particles, BlockMatrix& blocks) {
  const int vertices = particles.size();
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(vertices);
  BlocksOfVertex of_vertex(vertices);
  do {
    blocks.begin(particles, nothing);
    for (int v = 0; v < vertices; ++v) of_vertex.add(matrix, v, blocks);
  } while (!blocks.finish());
}

}  // namespace

ElasticFactor::ElasticFactor(const Sparse& matrix) {
  const Eigen::Index vertices = matrix.cols() / 3;
  // Of which it asks only whether they are held: none is.
  const Particles particles(Positions::Zero(3, vertices), Eigen::VectorXd::Ones(vertices));
  BlockMatrix blocks;
  assemble(matrix, particles, blocks);
  factor_.prepare(blocks);
  const HeldRows none;
  factor_.analyze(blocks, none);
  if (!factor_.factor(blocks, none)) {
    throw InputError("the stiffness matrix cannot be factored: is a part of the body loose?");
  }
}

Eigen::VectorXd ElasticFactor::solve(const Eigen::Ref<const Eigen::VectorXd>& b) const {
  right_ = b.reshaped(3, b.size() / 3);
  left_.resize(3, right_.cols());
  factor_.solve(right_, left_);
  return left_.reshaped();
}

}  // namespace pliant
