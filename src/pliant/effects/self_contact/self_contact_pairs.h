#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pliant/core/system/constraint.h"

namespace pliant {

/// Two places of a body that must not come nearer along a normal. Particles carry them; what counts
/// is their difference, a sum over sixteen particles at the most: four points of four each.
struct PairContact {
  static constexpr int kParticles = 16;
  /// Kind of the two simplices that touch, and their four vertices.
  using Simplices = std::array<int, 5>;
  static constexpr Simplices kUnknown = {-1, -1, -1, -1, -1};

  Simplices simplices = kUnknown;

  std::size_t count = 0;                        ///< of the particles
  std::array<int, kParticles> particles;        ///< the first `count`
  std::array<double, kParticles> weights = {};  ///< they sum to 0
  Eigen::Vector3d normal;                       ///< from the surface to the point
  double least = 0.0;                           ///< of normal . relative() [m]
  Eigen::Vector3d start;                        ///< relative() when the step began [m]
  /// By how much its points came off where they stuck, which `start` has taken back [m].
  Eigen::Vector3d owed = Eigen::Vector3d::Zero();
  double friction = 0.0;                                     ///< Coulomb coefficient
  double adhesion = 0.0;                                     ///< that water withstands [N]
  double normal_force = 0.0;                                 ///< multiplier [N], >= -adhesion
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< multiplier [N], tangential
  double guess = 0.0;  ///< of the normal force, from the last iteration [N]
  Eigen::Vector3d friction_guess = Eigen::Vector3d::Zero();  ///< likewise [N]
  bool is_rigid = false;  ///< of two bodies that keep their shapes
  int corrections = 0;    ///< of a solver that moves all particles, which held it so far
  /// Direction in which the last of these corrections let it slide, zero where it stuck.
  Eigen::Vector3d slide = Eigen::Vector3d::Zero();

  bool is_held() const { return normal_force > -adhesion; }
  Eigen::Vector3d relative(const Positions& x) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < count; ++k) sum += weights[k] * x.col(particles[k]);
    return sum;
  }
};

/// Non-penetration without bounce and Coulomb friction of pairs, as a constraint treats them.
class PairContacts {
 public:
  /// A relax() makes `sweeps` over all pairs, or fewer where moves are far below `thickness` [m].
  PairContacts(double thickness, int sweeps) : thickness_(thickness), sweeps_(sweeps) {}

  std::vector<PairContact>& all() { return contacts_; }
  const std::vector<PairContact>& all() const { return contacts_; }

  void reset_multipliers();
  void relax(const Eigen::VectorXd& mobility, Positions& x);
  /// Moves places apart until none is much nearer than it should be, whatever else has to give.
  void separate(const Eigen::VectorXd& mobility, Positions& x);
  /// One sweep that leaves at least a share of what should be between two places: they have not
  /// passed. Returns how much of that was missing, as a multiple of what may be.
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) const;
  void add_forces(Forces& f) const;
  void add_rows(const Positions& x, ConstraintRows& rows);
  int active() const;

 private:
  /// Both return how far the places moved [m].
  double project(PairContact& contact, double own, const Eigen::VectorXd& mobility,
                 Positions& x) const;
  /// By how much they are too near; not above 0: not at all, or nobody can move them [m].
  static double missing(const PairContact& contact, const Eigen::VectorXd& mobility,
                        const Positions& x);
  double rub(PairContact& contact, double own, const Eigen::VectorXd& mobility, Positions& x) const;
  void add_friction_rows(PairContact& contact, const Positions& x, ConstraintRows& rows) const;

  double thickness_;
  int sweeps_;
  std::vector<PairContact> contacts_;
  // Of a sweep of separate(): what is missing at its beginning, and who moved, by its number.
  std::vector<double> missing_;
  std::vector<int> moved_;
};

}  // namespace pliant
