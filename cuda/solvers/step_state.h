#pragma once

#include "cuda/core/vector.h"
#include "cuda/elements/cluster_forces.h"
#include "cuda/elements/packed_rotation.h"
#include "cuda/elements/simplex_forces.h"
#include "cuda/elements/sliced_rows.h"

namespace pliant {

/// Views of a packed system (packed_system.h) in the memory of an executor.
struct RowsView {
  const int* begins = nullptr;  ///< null: none
  const int* neighbors = nullptr;
  const float* a = nullptr;
  const float* b = nullptr;
};

/// Neighbours are numbered within the block.
struct LocalRowsView {
  const int* begins = nullptr;  ///< null: none
  const unsigned short* neighbors = nullptr;
  const float* a = nullptr;
  const float* b = nullptr;
};

/// What blocks read besides their own places (block_borders.h).
struct BordersView {
  const int* begins = nullptr;  ///< null: nothing
  const int* places = nullptr;
};

struct SimplicesView {
  const int* begins = nullptr;  ///< null: none
  const UShort4* places = nullptr;
  const UShort4* slots = nullptr;
  const Float4* numbers = nullptr;
  PackedRotation* rotation = nullptr;  ///< of the last iteration; null: not of tetrahedra
  int size = 0;
};

struct ElementsView {
  BordersView borders;
  LocalRowsView springs, cells, quadratic;
  ClustersView clusters;
  SimplicesView tetrahedra, fibers, triangles;
  const MembraneConstants<float>* materials = nullptr;
  const int* slot_begins = nullptr;  ///< null: no simplices
  int shared_blocks = 0;             ///< PackedSystem

  /// The block whose elements `block` reads.
  PLIANT_HOST_DEVICE int pattern_of(int block) const {
    return shared_blocks == 0 ? block : block % shared_blocks;
  }
};

/// A contact of the running step, as it is where the prediction puts its point.
struct DeviceContact {
  static constexpr int kParticles = 4;  ///< at the most

  Int4 particles;  ///< that carry the point; -1: no more
  Float4 weights;
  Float4 plane;  ///< normal, and the gap there [m]
  Float4 slip;   ///< from where the point would be if it stuck [m], and Coulomb's coefficient
};

/// What contact did to a point.
struct DeviceContactForce {
  float normal;     ///< [N]
  Float3 friction;  ///< [N]
};

struct ContactsView {
  bool any = false;
  /// First contact and first touched particle of each scene, and their ends: they change from step
  /// to step.
  const int* begins_of_scenes = nullptr;
  const DeviceContact* contacts = nullptr;
  DeviceContactForce* forces = nullptr;
  // Per touched particle its contacts: entry k is contact number entries[k] / 4 as its corner
  // entries[k] % 4.
  const int* touched = nullptr;
  const int* begins = nullptr;
  const int* entries = nullptr;
  const int* first = nullptr;  ///< per particle: its number among the touched, or -1
};

/// Sums over all particles that a measured iteration leaves behind.
enum Measure : int {
  kChange,   ///< |J(y) - y|² in the norm of D
  kUphill,   ///< (y - J(y)) . (J(y) - J(y_before)) in the norm of D
  kActive,   ///< contacts that carry force
  kContact,  ///< |D^-1/2 f_contact|²
  kPulled,   ///< |D^-1/2 r|²
  kMeasures
};

/// Iterations between two looks at how the step goes.
constexpr int kInterval = 8;

/// How a step's iterations go on; written by kernels of one block a scene alone.
struct StepControl {
  enum Mode : int { kChebyshev, kMomentum };
  enum Result : int { kIterate, kLatest, kBest, kNotFinite };

  float factors[kInterval];  ///< ω or the share of momentum, of the iterations to come
  int mode;
  float slow;   ///< of the mobility; 1 unless momentum has to be damped
  int done_at;  ///< iterations after which the step was done; -1 while it is not
  int revert;   ///< the next iteration begins with the best state
  int best;     ///< which of StepArrays::saved is the best state
  int latest;   ///< and which the last measured one
  int result;
  int plain;        ///< iterations without acceleration still to come
  int accelerated;  ///< iterations since the recurrence began
  int restarts;
  int touched;
  int damped;      ///< momentum grew: it takes shorter steps
  int plain_only;  ///< it grew with these too: no more of it in this step
  int lowered;
  int is_round_off;
  float omega;
  double radius, momentum;
  double first_change, last_change, best_change;
  double scale;  ///< of the residual
  double residual;
  double active;
  float mean_correction;  ///< weighted: mean of |γ D⁻¹ r| [m]
  float step;             ///< α of the last iteration; 1 where there is none
  int rests;              ///< quasi-Newton: this part of an iteration is not for contacts
  int shortened;          ///< quasi-Newton: steps that the line search refused

  /// Whether later steps have to be damped too: where it began to be, few iterations were left to
  /// mend what grew. A step that converged all the same says that momentum does no harm here.
  PLIANT_HOST_DEVICE bool stays_damped() const {
    constexpr double kLarge = 0.1;  // a warning of the step itself takes 0.5
    return damped != 0 && residual > kLarge;
  }
};

/// What does not change during a step.
struct StepRules {
  float quantum = 1.0f;  ///< of positions [m]
  double rho = 0.0;      ///< spectral radius that the step begins with; 0: plain Jacobi
  double rho_bound = 0.0;
  bool is_accelerated = false;  ///< else plain Jacobi, also where contact carries force
  bool may_raise = false;
  double tolerance = 0.0;
  double gamma = 1.0;
  double damped = 1.0;     ///< share of the mobility with which momentum is surely stable
  bool is_damped = false;  ///< momentum grew in an earlier step
  double round_off = 0.0;  ///< norm of forces that are round-off alone
  double noise = 0.0;      ///< and of those too small to judge a recurrence by
  int delay = 0;           ///< plain iterations before acceleration
  bool is_due = true;      ///< else the scene stays as it is
  bool embedded = false;   ///< it has contacts whose points share particles
  int least = 1;           ///< iterations before which no residual ends the step
  bool keeps_best = true;  ///< else no iteration goes back, and the last one is the result
  float spread = 1.0f;     ///< of weights (DeviceIteration)
  int particles = 0;       ///< of the scene
  // Quasi-Newton: Chebyshev's sweeps are for eigenvalues of D⁻¹A between these.
  float least_eigenvalue = 1.0f, largest_eigenvalue = 1.0f;
};

/// What belongs to one of the scenes that are stepped together.
struct SceneState {
  StepControl& control;
  const StepRules& rules;
};

/// Arrays of the iterations, in the order of the packed system.
struct StepArrays {
  int particles = 0;
  int block = 0;
  const int* scene_of_block = nullptr;   ///< null: there is one scene
  Fixed* x[2] = {nullptr, nullptr};      ///< y_k and y_{k-1} in turn
  const Fixed* predicted = nullptr;      ///< y of the objective, and M/h² [N/m]
  const float* mobility = nullptr;       ///< γ/D, 0 for a fixed particle [m/N]
  const Fixed* anchors = nullptr;        ///< mean of attachments' targets, Σ k [N/m]; null: none
  Fixed* raw = nullptr;                  ///< J(y) before contacts whose points share particles
  Fixed* pushed = nullptr;               ///< and after them
  Fixed* projected = nullptr;            ///< J(y) of the last iteration, for momentum
  Fixed* saved[2] = {nullptr, nullptr};  ///< J(y) of the best and of the last measured iteration
  float* partial = nullptr;              ///< kMeasures a block
  const StepRules* rules = nullptr;      ///< one a scene
  StepControl* control = nullptr;        ///< likewise

  /// Where place i is when the iterations are over.
  PLIANT_HOST_DEVICE Fixed ended(const StepControl& c, int i) const {
    if (c.result == StepControl::kLatest) return saved[c.latest][i];
    if (c.result == StepControl::kBest) return saved[c.best][i];
    return x[c.done_at % 2][i];
  }
  PLIANT_HOST_DEVICE SceneState scene(int number) const { return {control[number], rules[number]}; }
  PLIANT_HOST_DEVICE int number_of(int in_block) const {
    return scene_of_block == nullptr ? 0 : scene_of_block[in_block];
  }
  PLIANT_HOST_DEVICE SceneState scene_with(int in_block) const {
    return scene(number_of(in_block));
  }
};

}  // namespace pliant
