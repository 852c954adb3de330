#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/models/reduced/polynomial_kernel.h"

namespace pliant {

/// The elastic energy of a reduced St. Venant-Kirchhoff body, a quartic polynomial of r reduced
/// coordinates q with V(0) = 0, ∇V(0) = 0 and a diagonal Hessian diag(λ) at 0:
///   V = ½ Σ λᵢ qᵢ² + Σ_{i≤j≤k} aᵢⱼₖ qᵢ qⱼ qₖ + Σ_{i≤j≤k≤l} cᵢⱼₖₗ qᵢ qⱼ qₖ qₗ   [J].
/// Its gradient is the cubic polynomial R(q) of Barbič and James 2005 (equation 13), its Hessian
/// the tangent K(q). Each coefficient is stored once, about r⁴/24 of them, where the coefficients
/// of R itself are r⁴/6; and all three are found from the products sᵢⱼ = qᵢ qⱼ in one pass:
///   V₃ + V₄ = Σₖ qₖ (aₖ + Σ_{l≥k} qₗ c_kl) · s,
/// with aₖ and c_kl vectors over the pairs i ≤ j ≤ k.
class QuarticPotential {
 public:
  /// Room for intermediate results, one a thread; resized where needed.
  struct Workspace {
    ForceSpace force;
    LaneVector s, sum, row_sum, spread;
    std::vector<double> weights, dots;
    Eigen::VectorXd column;
  };

  QuarticPotential() = default;
  /// `coefficients` in the order of index(). Throws InputError, beginning with `where`, for a rank
  /// outside [1, kMaxRank], a λ that is negative, another number of coefficients than
  /// coefficient_count(), or a value that is not finite.
  QuarticPotential(Eigen::VectorXd lambda, const std::vector<double>& coefficients,
                   const std::string& where);

  int rank() const { return static_cast<int>(lambda_.size()); }
  const Eigen::VectorXd& lambda() const { return lambda_; }

  /// V(q) [J].
  double energy(const Eigen::VectorXd& q, Workspace& workspace) const;
  /// V(q), and R(q) = ∇V.
  double evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& r, Workspace& workspace) const;
  /// V(q), R(q) and K(q) = ∇∇V.
  double evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& r, Eigen::MatrixXd& k,
                  Workspace& workspace) const;

  /// Cubic and quartic coefficients: C(r+2, 3) + C(r+3, 4).
  static std::int64_t coefficient_count(int rank);
  /// Where aᵢⱼₖ is, i <= j <= k: blocks of k; in each first the row aₖ, then the rows c_kl with l
  /// from k to r - 1; in each row the pairs (0,0), (0,1), (1,1), (0,2), ... (k,k).
  static std::int64_t index(int rank, int i, int j, int k);
  /// Where cᵢⱼₖₗ is, i <= j <= k <= l.
  static std::int64_t index(int rank, int i, int j, int k, int l);
  /// All coefficients in this order.
  std::vector<double> coefficients() const;
  /// Bytes of coefficients that one evaluation reads, padding included.
  std::int64_t bytes() const { return static_cast<std::int64_t>(blocks_.size() * sizeof(Lanes)); }

 private:
  CoefficientRows block(int k) const;
  void prepare(const Eigen::VectorXd& q, Workspace& workspace) const;
  void set_weights(const Eigen::VectorXd& q, int k, double scale, Workspace& workspace) const;

  Eigen::VectorXd lambda_;
  LaneVector blocks_;
  std::vector<std::size_t> begins_;  // of each k's block
};

}  // namespace pliant
