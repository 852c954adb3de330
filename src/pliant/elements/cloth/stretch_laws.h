#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/solids/principal_stretches.h"

namespace pliant {

/// Laws of StencilSet: energies per stiffness and volume of parts of a solid, functions of their
/// deformation gradients G and of a stretch that each part of a viscous set remembers.

/// Ψ = min_R |G − R U|², the squared distance to all rotations of a stretch U, I where nothing is
/// remembered. At the minimum R is the rotation nearest to G U. Of G = R' U' with a U' near U that
/// is |U' − U|², whatever R'.
struct ShearLaw {
  std::vector<Eigen::Matrix3d> remembered;  ///< U of each part, symmetric; empty: all are I

  static constexpr double kBound = 2.0;  ///< d²Ψ/dG² <= kBound I
  void stresses(int first, const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  double energy(const Eigen::Matrix3d& stress) const { return 0.25 * stress.squaredNorm(); }
  Matrix9d tangent(int part, const Eigen::Matrix3d& g, Definiteness definiteness) const;
  /// What it remembers of a part: of G = R U, U, and in time beyond it by `share` of its change
  /// since G was `before`.
  void resize(int parts) { remembered.resize(static_cast<std::size_t>(parts)); }
  void remember(int part, const Eigen::Matrix3d& g);
  void remember(int part, const Eigen::Matrix3d& g, const Eigen::Matrix3d& before, double share);
};

/// Ψ = 1/2 (Σσ − s)², σ the principal stretches of G, s their sum that is remembered, or 3.
struct PressureLaw {
  std::vector<double> remembered;  ///< s − 3 of each part; empty: all are 0

  static constexpr double kBound = 3.0;
  void stresses(int first, const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  /// The stress is (Σσ − s) R.
  double energy(const Eigen::Matrix3d& stress) const { return stress.squaredNorm() / 6.0; }
  Matrix9d tangent(int part, const Eigen::Matrix3d& g, Definiteness definiteness) const;
  void resize(int parts) { remembered.resize(static_cast<std::size_t>(parts)); }
  void remember(int part, const Eigen::Matrix3d& g);
  void remember(int part, const Eigen::Matrix3d& g, const Eigen::Matrix3d& before, double share);
};

}  // namespace pliant
