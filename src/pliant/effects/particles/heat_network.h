#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/effects/particles/heat_material.h"

namespace pliant {

/// Nodes that hold heat and pass it on to each other and to what is outside, for steps of any
/// length: implicit Euler on the enthalpy. With T(H) the temperature that belongs to the heat H,
///   Hᵢ' = Hᵢ + h [Σⱼ Gᵢⱼ (Tⱼ' − Tᵢ') + Bᵢ − Pᵢ Tᵢ'],  T' = T(H').
/// No step is too long: temperatures stay between those of the nodes and of the outside. The
/// equations are the gradient of a convex function of T', which is minimised by Newton's method
/// with an exact line search (with melting ranges it is piecewise quadratic), each linear system by
/// conjugate gradients, preconditioned by its diagonal and the mean of each connected component,
/// without which a component of small heat capacity that conducts well would never find its level.
class HeatNetwork {
 public:
  struct Result {
    double from_outside = 0.0;  ///< heat that came in [J]
    bool converged = true;
  };

  /// Conductances G in rows: node i has the neighbours others[begins[i]] to others[begins[i + 1]],
  /// none of them itself, and G is symmetric [W/K].
  std::vector<int> begins, others;
  std::vector<double> conductances;
  Eigen::VectorXd passes, brings;              ///< P [W/K] and B [W] of each node
  Eigen::VectorXd masses;                      ///< [kg]
  std::vector<const HeatMaterial*> materials;  ///< of each node

  /// To be called once what is above is set.
  void prepare();
  /// Takes `heat` [J] and the `temperature` that belongs to it [K] on by dt > 0 [s]. A component
  /// that nothing outside reaches keeps its heat to round-off, converged or not.
  Result step(double dt, Eigen::VectorXd& heat, Eigen::VectorXd& temperature);

 private:
  int size() const { return static_cast<int>(masses.size()); }
  double heat_at(int i, double temperature) const;
  double slope_at(int i, double temperature) const;
  /// y = Pᵢ xᵢ + Σⱼ Gᵢⱼ (xᵢ − xⱼ)
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  void find_components();
  void precondition(const Eigen::VectorXd& residual, Eigen::VectorXd& z) const;
  bool solve(double dt, double tolerance, const Eigen::VectorXd& right, Eigen::VectorXd& x);
  double share_of_step(double dt, const Eigen::VectorXd& temperature,
                       const Eigen::VectorXd& direction) const;
  double settle(const Eigen::VectorXd& temperature, Eigen::VectorXd& heat) const;

  Eigen::VectorXd sums_;               // Pᵢ + Σⱼ Gᵢⱼ [W/K]
  std::vector<int> component_;         // of each node
  std::vector<char> is_open_;          // whether anything outside reaches a component
  Eigen::VectorXd slopes_, diagonal_;  // dH/dT, and of the linear system [J/K]
  Eigen::VectorXd levels_;             // of each component: its sum of the linear system [J/K]
  Eigen::VectorXd missing_, change_;   // of the equations [J]; of the temperatures [K]
  Eigen::VectorXd z_, p_, q_;          // of the conjugate gradients
  mutable Eigen::VectorXd means_, along_;
};

}  // namespace pliant
