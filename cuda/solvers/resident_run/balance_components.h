#pragma once

#include "cuda/solvers/resident_run/resident_step.h"

/// What keeps the momentum of connected components in a resident run, as MomentumBalance
/// (src/pliant/solvers/checks/momentum_balance.h) does it for single steps: each component moves as
/// a rigid body, and its contacts answer that with Coulomb's law, until the impulses are balanced.
namespace pliant {

struct MotionSearch;

/// Components that nothing holds from outside, as views of an executor's memory. A component's
/// members are taken in runs of kRun.
struct BalanceComponents {
  static constexpr int kRun = 128, kHalvings = 7;
  static_assert(1 << kHalvings == kRun, "all members of a run are added up");
  /// Sums of a run, about where the component's first member was when the step began.
  enum Number : int {
    kMass,          ///< Σ m, where m is M/h² [N/m]
    kFirst,         ///< Σ m q
    kSecond = 4,    ///< Σ m q qᵀ: xx, yy, zz, xy, xz, yz
    kForce = 10,    ///< of all forces but those of contacts [N]
    kTorque = 13,   ///< [N m]
    kPushed = 16,   ///< forces of contacts [N]
    kTwisted = 19,  ///< their torque [N m]
    kSize = 22,     ///< Σ |force|, of which sums are round-off
    kMoved,    ///< Σ m |displacement of the step|², with what external forces add to it [N m]
    kAlone,    ///< what φ without elements gains where contacts move their particles alone [N m]
    kTouched,  ///< how many have contacts
    kNumbers
  };

  int count = 0, runs = 0;
  const int* members = nullptr;      ///< places, component after component
  const int* begins = nullptr;       ///< of each component's members, and the end
  const int* run_begins = nullptr;   ///< of each component's runs, and the end
  const int* of_run = nullptr;       ///< component of a run
  double* sums = nullptr;            ///< kNumbers a run
  int* touched = nullptr;            ///< of a run, first of all its members that have contacts
  int* touched_count = nullptr;      ///< how many these are
  Float4* rows = nullptr;            ///< slip and gap of each contact, as it is balanced [m]
  double* answers = nullptr;         ///< of a run's contacts (ContactAnswer)
  MotionSearch* searches = nullptr;  ///< one a component
  BalanceMotion* missed = nullptr;   ///< motions of components that velocities lack

  PLIANT_HOST_DEVICE int first_of(int component) const { return members[begins[component]]; }
};

}  // namespace pliant
