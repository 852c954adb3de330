#pragma once

#include "cuda/solvers/matrix/quasi_newton_state.h"

/// Iterations of L-BFGS (LbfgsSolver) on a packed system, as functions of one thread: forces, the
/// line search, and Jacobi iterations for contacts. Directions: quasi_newton_direction.h.
namespace pliant {

/// Sums over all particles that the forces at a state leave behind; norms in that of γ/D.
enum ForceMeasure : int {
  kBalanceSum,  ///< |r + f_contact|²
  kHeldSum,     ///< |f_contact|²
  kPulledSum,   ///< |r|²
  kActiveSum,   ///< contacts that carry force
  kNearSum,     ///< particles that have contacts
  kSlopeFrom,   ///< d · (r + f_contact) where d begins [J]
  kSlopeTo,     ///< and at the state
  kForceMeasures
};

/// The first state and what belongs to it.
struct BeginQuasiNewton {
  StepArrays arrays;
  QuasiNewtonView view;
  const Fixed* start;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    arrays.saved[0][i] = start[i];
    view.holds[i] = {0.0f, 0.0f, 0.0f, Hold::kFree};
  }
};

/// Of each scene.
struct BeginQuasiNewtonState {
  StepArrays arrays;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int number) const {
    const SceneState scene = arrays.scene(number);
    scene.control.result = StepControl::kBest;
    QuasiNewtonState& s = view.states[number];
    s.iterations = s.least_at = s.held = s.next = s.is_retry = s.retries = s.has_moved = 0;
    s.is_plain = 1;
    s.sweeps = 1;
    s.sweeps_left = 0;
    s.step = 1.0f;
    s.least_balance = 1e300;
    plan(scene.rules, s);
  }

 private:
  /// Chebyshev's iteration on D⁻¹A z = D⁻¹q for eigenvalues within the bounds. What it leaves of
  /// those below is less than all and more than nothing: as a function of A it is positive
  /// definite whatever the lower bound.
  PLIANT_HOST_DEVICE void plan(const StepRules& rules, QuasiNewtonState& s) const {
    const double low = rules.least_eigenvalue, high = rules.largest_eigenvalue;
    const double middle = 0.5 * (high + low);
    const double half = 0.5 * (high - low) > 1e-6 * middle ? 0.5 * (high - low) : 1e-6 * middle;
    double rho = half / middle;
    s.momentum[0] = 0.0f;
    s.pull[0] = static_cast<float>(1.0 / (middle * rules.gamma));
    for (int k = 1; k < view.sweeps; ++k) {
      const double before = rho;
      rho = 1.0 / (2.0 * middle / half - before);
      s.momentum[k] = static_cast<float>(rho * before);
      s.pull[k] = static_cast<float>(2.0 * rho / (half * rules.gamma));
    }
  }
};

/// Where forces are asked for.
struct AskedState {
  StepArrays arrays;
  bool is_trial;  ///< where the step tries to go; else where it has come to

  PLIANT_HOST_DEVICE bool runs(const StepControl& control) const {
    return control.done_at < 0 && (is_trial || control.rests == 0);
  }
  PLIANT_HOST_DEVICE int saved(const StepControl& control) const {
    return is_trial ? 1 - control.best : control.best;
  }
  PLIANT_HOST_DEVICE const Fixed* source(const StepControl& control) const {
    return arrays.saved[saved(control)];
  }
};

/// r there.
struct ForceStep {
  static constexpr int kMostThreads = BlockForces::kMostThreads;
  static constexpr int kLeastBlocks = BlockForces::kLeastBlocks;
  static constexpr int kForces = BlockForces::kPhases, kPhases = kForces + 3;
  using Sums = BlockSum<kForceMeasures>;

  BlockForces forces;
  ContactsView contacts;
  AskedState asked;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const StepArrays& arrays = asked.arrays;
    const SceneState scene = arrays.scene_with(block);
    if (!asked.runs(scene.control)) return;
    float* sums = shared + forces.layout.before_sums();
    if (phase < kForces) {
      forces(phase, arrays, asked.source(scene.control), scene.rules.quantum, block, thread,
             shared);
    } else if (phase == kForces) {
      if (thread >= arrays.block) return;
      Sums::clear(sums + thread * kForceMeasures);
      const int i = block * arrays.block + thread;
      if (i < arrays.particles) measure(scene, i, block, shared, sums + thread * kForceMeasures);
    } else if (phase == kForces + 1) {
      Sums::first(sums, arrays.block, thread);
    } else {
      Sums::second(sums, thread, arrays.partial + block * kForceMeasures);
    }
  }

 private:
  PLIANT_HOST_DEVICE void measure(const SceneState& scene, int i, int block, const float* shared,
                                  float* sums) const {
    const StepArrays& arrays = asked.arrays;
    const int at = asked.saved(scene.control);
    const float mobility = arrays.mobility[i];
    if (mobility == 0.0f) {
      view.forces[at][i] = {0.0f, 0.0f, 0.0f, 0.0f};
      return;
    }
    const Float3 r = forces.unbalanced(arrays, i, block, scene.rules.quantum, shared);
    view.forces[at][i] = with_w(r, 0.0f);
    int active;
    const Float3 held = contact_force(contacts, i, active);
    sums[kBalanceSum] =
        is_in_range(arrays.saved[at][i]) ? mobility * dot(r + held, r + held) : HUGE_VALF;
    sums[kHeldSum] = mobility * dot(held, held);
    sums[kPulledSum] = mobility * dot(r, r);
    sums[kActiveSum] = static_cast<float>(active);
    sums[kNearSum] = contacts.any && contacts.first[i] >= 0 ? 1.0f : 0.0f;
    if (!asked.is_trial) return;
    const Float3 d = view.wanted[i].xyz();
    sums[kSlopeFrom] = dot(d, view.forces[1 - at][i].xyz() + held);
    sums[kSlopeTo] = dot(d, r + held);
  }
};

/// What the forces at a state say of it. A block a scene.
struct JudgeStep {
  using Sums = SceneSum<kForceMeasures>;
  static constexpr int kPhases = Sums::kPhases;
  enum Where : int { kFirst, kTrial, kSwept };
  // The slope where a step ends is no more than that times the one where it begins: then φ falls by
  // at least (1 − kSteepest) / 2 of what its slope promises, were it quadratic. φ itself tells
  // nothing in single precision long before slopes do.
  static constexpr double kSteepest = 0.8;
  static constexpr int kMostRetries = 4;
  static constexpr int kMostSweeps = 4;
  // Where forces are noise for so long, no iteration betters what single precision leaves.
  static constexpr int kPatience = 16;

  StepArrays arrays;
  QuasiNewtonView view;
  const int* begins;  ///< first block of each scene, and the end
  Where where;
  int iterations;  ///< of the step, at the most

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0 || (where == kSwept && scene.control.rests)) return;
    QuasiNewtonState& state = view.states[number];
    auto* sums = reinterpret_cast<double*>(shared);
    Sums::add(phase, arrays.partial, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    double total[kForceMeasures];
    Sums::total(sums, total);
    judge(scene, state, total);
  }

 private:
  PLIANT_HOST_DEVICE void judge(const SceneState& scene, QuasiNewtonState& s,
                                const double* total) const {
    StepControl& c = scene.control;
    bool goes_on = true;
    if (where == kTrial) {
      ++s.iterations;
      goes_on = search(s, total);
      if (goes_on) {
        c.best = 1 - c.best;
      } else {
        ++c.shortened;
      }
    }
    s.sweeps_left = where == kSwept ? s.sweeps_left - 1 : 0;
    if (where != kSwept && goes_on && total[kNearSum] > 0.0) {
      s.sweeps_left = where == kFirst ? 1 : s.sweeps;
    }
    c.rests = s.sweeps_left == 0 ? 1 : 0;
    if (goes_on && c.rests) conclude(scene, s, total);
    if (s.iterations == iterations && c.rests && c.done_at < 0) c.done_at = iterations;
  }

  /// Whether the trial is where the step goes on from.
  PLIANT_HOST_DEVICE static bool search(QuasiNewtonState& s, const double* total) {
    const double from = total[kSlopeFrom], to = total[kSlopeTo];
    const bool is_finite = total[kBalanceSum] < 1e300;
    // Without pairs the step is one of projective dynamics, which never raises φ; one of
    // multigrid that is too long for what contacts hold has to be shorter.
    const bool is_plain =
        s.is_plain != 0 && (to >= -from || !is_finite || s.retries == kMostRetries);
    if ((is_finite && to >= -kSteepest * from && from > 0.0) || is_plain) {
      s.has_moved = 1;
      s.is_retry = s.retries = 0;
      s.step = 1.0f;
      return true;
    }
    if (is_finite && from > 0.0 && s.retries < kMostRetries) {
      const double root = from / (from - to);
      s.step *= static_cast<float>(root < 0.1 ? 0.1 : (root > 0.5 ? 0.5 : root));
      s.is_retry = 1;
      ++s.retries;
      return false;
    }
    s.held = s.has_moved = s.is_retry = s.retries = 0;
    s.step = 1.0f;
    return false;
  }

  /// How the iteration ended; its residual as StepObjective::relative_residual().
  PLIANT_HOST_DEVICE void conclude(const SceneState& scene, QuasiNewtonState& s,
                                   const double* total) const {
    const auto& [c, rules] = scene;
    const double balance = std::sqrt(total[kBalanceSum] / rules.gamma);
    if (!(balance < 1e300)) {
      finish(c, s);
      c.result = StepControl::kNotFinite;
      return;
    }
    if (s.iterations <= 1) {
      for (ForceMeasure part : {kHeldSum, kPulledSum}) {
        const double size = std::sqrt(total[part] / rules.gamma);
        if (size > c.scale) c.scale = size;
      }
    }
    c.active = total[kActiveSum];
    // Contacts that come and go from one correction to the next may do so for ever.
    if (balance >= s.least_balance && s.sweeps < kMostSweeps) s.sweeps *= 2;
    if (balance < s.least_balance) {
      s.least_balance = balance;
      s.least_at = s.iterations;
    }
    const double scale = c.scale > rules.round_off ? c.scale : rules.round_off;
    c.residual = balance <= rules.noise ? 0.0 : balance / scale;
    const bool is_noise = s.iterations > s.least_at + kPatience && balance <= rules.noise;
    c.is_round_off = balance <= rules.round_off || is_noise;
    if (s.iterations == 0 && !c.is_round_off) return;
    if (balance <= rules.tolerance * c.scale || c.is_round_off) finish(c, s);
  }
  PLIANT_HOST_DEVICE static void finish(StepControl& c, const QuasiNewtonState& s) {
    c.done_at = s.iterations > 1 ? s.iterations : 1;
  }
};

/// A Jacobi iteration with contacts, from forces that are known: all of it, or, where contact
/// points share particles, up to these.
struct TouchStep {
  StepArrays arrays;
  ContactsView contacts;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int in_block = i / arrays.block;
    const SceneState scene = arrays.scene_with(in_block);
    if (scene.control.done_at >= 0 || scene.control.rests) return;
    Fixed& x = arrays.saved[scene.control.best][i];
    const float quantum = scene.rules.quantum, mobility = arrays.mobility[i];
    const Float3 displacement = mobility * view.forces[scene.control.best][i].xyz();
    const Fixed raw = moved(x, (1.0f / quantum) * displacement);
    if (scene.rules.embedded) {
      arrays.raw[i] = arrays.pushed[i] = raw;
      return;
    }
    x = raw;
    const int number = mobility > 0.0f ? contacts.first[i] : -1;
    if (number < 0) return;
    const Float3 from = quantum * (raw - arrays.predicted[i]);
    Float3 u = from;
    touch(contacts, number, mobility, u);
    x = moved(raw, (1.0f / quantum) * (u - from));
  }
};

/// The rest of it.
struct LandTouched {
  StepArrays arrays;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const SceneState scene = arrays.scene_with(i / arrays.block);
    if (scene.control.done_at >= 0 || scene.control.rests || !scene.rules.embedded) return;
    arrays.saved[scene.control.best][i] = arrays.pushed[i];
  }
};

}  // namespace pliant
