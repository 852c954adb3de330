#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

class KeepsConditions;

/// A linear condition on the displacement d of some particles, J d = c − C Δ, held by the forces
/// Jᵀ Δ, where Δ is by how much a multiplier of the coupling that asks for it changes.
struct KeptCondition {
  KeepsConditions* owner = nullptr;
  int number = 0;  ///< of the owner's
  std::vector<int> particles;
  Eigen::Matrix3Xd gradient;       ///< J, 3 x as many
  double target = 0.0;             ///< c
  double compliance = 0.0;         ///< C >= 0
  double least = 0.0, most = 0.0;  ///< of Δ
};

/// A coupling with conditions that tie many particles and that the last words of others must keep:
/// what moves all particles at once has to know of them. While that goes on multipliers have
/// changes, 0 at first.
class KeepsConditions {
 public:
  virtual ~KeepsConditions() = default;
  /// By how much the worst of them is missed at `x` with the changes, in what may be left of it.
  virtual double missed_conditions(const Positions& x) = 0;
  /// Appends conditions on how particles go on from `x`, about where the changes are.
  virtual void add_conditions(const Positions& x, std::vector<KeptCondition>& conditions) = 0;
  virtual void set_change(int number, double change) = 0;
  /// The multipliers change so.
  virtual void take_changes() = 0;
};

}  // namespace pliant
