#pragma once

#include "cuda/core/mailbox.h"
#include "cuda/solvers/step_state.h"
#include "cuda/solvers/sums.h"
#include "pliant/laws/acceleration.h"

/// What decides how a step's iterations go on, as ChebyshevSolver does, at every interval: raises a
/// radius that lags, lowers one that diverges, follows Nesterov's momentum while contact carries
/// force, keeps the best state, stops at the tolerance and at round-off.
namespace pliant {

/// Iterations between looks of the control: the first one says how large forces are, those up to
/// the delay how plain iterations do.
struct IterationPlan {
  int iterations, delay;

  /// Of the interval after so many; 0: none is left.
  PLIANT_HOST_DEVICE int length(int done) const {
    int most = done == 0 ? 1 : kInterval;
    if (done > 0 && done < delay && delay - done < most) most = delay - done;
    return most < iterations - done ? most : iterations - done;
  }
  /// Whether the interval after so many is the last one.
  PLIANT_HOST_DEVICE bool is_last(int done) const {
    return done < iterations && done + length(done) == iterations;
  }
};

/// How it goes on after an interval.
struct StepDecision {
  int iterations;      ///< so far
  int next;            ///< iterations in the next interval; 0: this was the last
  bool last_interval;  ///< the next one is

  /// `total`: kMeasures numbers of the last iteration.
  PLIANT_HOST_DEVICE void operator()(const SceneState& scene, const double* total) const {
    const auto& [c, rules] = scene;
    const double change = std::sqrt(rules.gamma * total[kChange]) / c.slow;
    c.revert = 0;
    c.latest = 1 - c.best;
    c.active = total[kActive];
    c.last_change = change;
    if (iterations <= 2) {
      const double largest = larger(total[kPulled], total[kContact]);
      c.scale = larger(c.scale, std::sqrt(largest / rules.gamma) / c.slow);
    }
    const double residual = change / rules.gamma;
    c.residual = residual <= rules.noise ? 0.0 : residual / larger(c.scale, rules.round_off);
    if (!(change < 1e300)) {
      finish(c, StepControl::kNotFinite);
      return;
    }
    const bool touches = total[kActive] > 0.0;
    const IterationChange judged = {change, change <= rules.gamma * rules.noise};
    if (!rules.keeps_best || !revert_if_grown(scene, judged, touches)) {
      if (!rules.keeps_best || judged.is_best(c.best_change)) {
        c.best_change = change;
        c.best = c.latest;
      }
      const bool may_end = iterations >= rules.least;
      c.is_round_off = may_end && residual <= rules.round_off;
      if (may_end && (residual <= rules.tolerance * c.scale || c.is_round_off)) {
        finish(c, StepControl::kBest);
        return;
      }
    }
    if (next == 0) {
      finish(c, c.best_change < change ? StepControl::kBest : result(c, touches));
      return;
    }
    c.touched = touches;
    if (!rules.is_accelerated) return;
    if (touches) {
      plan_momentum(scene, total[kUphill] > 0.0);
    } else {
      plan_chebyshev(scene, judged);
    }
  }

 private:
  PLIANT_HOST_DEVICE static double larger(double a, double b) { return a > b ? a : b; }
  /// Contact holds exactly where its own projection came last.
  PLIANT_HOST_DEVICE static int result(const StepControl& c, bool touches) {
    return touches || c.mode == StepControl::kMomentum ? StepControl::kLatest
                                                       : StepControl::kIterate;
  }
  PLIANT_HOST_DEVICE void finish(StepControl& c, int result) const {
    c.done_at = iterations;
    c.result = result;
  }
  PLIANT_HOST_DEVICE static void restart(StepControl& c, int plain) {
    c.plain = plain;
    c.accelerated = 0;
    c.omega = 1.0f;
  }

  /// Back to the best state where acceleration made things worse.
  PLIANT_HOST_DEVICE static bool revert_if_grown(const SceneState& scene,
                                                 const IterationChange& judged, bool touches) {
    const auto& [c, rules] = scene;
    if (touches && c.touched && !c.plain_only && judged.has_grown_beyond(c.best_change)) {
      c.plain_only = c.damped;
      c.damped = 1;
      c.slow = momentum_pace(scene);
    } else if (!touches && c.accelerated > 0 && judged.has_grown_beyond(c.first_change)) {
      SpectralRadius radius(rules.rho_bound);
      radius.set(c.radius);
      radius.lower();
      c.radius = radius.value();
      c.lowered = 1;
    } else {
      return false;
    }
    c.revert = 1;
    ++c.restarts;
    c.touched = 0;
    // Two, so that the iterate before the recurrence comes from the best state too.
    restart(c, 2);
    return true;
  }

  /// Plain iterations need no shorter steps.
  PLIANT_HOST_DEVICE static float momentum_pace(const SceneState& scene) {
    const auto& [c, rules] = scene;
    return c.damped != 0 && c.plain_only == 0 ? static_cast<float>(rules.damped) : 1.0f;
  }

  PLIANT_HOST_DEVICE void plan_momentum(const SceneState& scene, bool uphill) const {
    const auto& [c, rules] = scene;
    c.slow = momentum_pace(scene);
    if (c.mode != StepControl::kMomentum || uphill) c.momentum = 1.0;
    c.mode = StepControl::kMomentum;
    for (int k = 0; k < next; ++k) {
      const NesterovStep step = nesterov_step(c.momentum);
      c.factors[k] = c.plain_only != 0 ? 0.0f : static_cast<float>(step.share);
      c.momentum = step.next;
    }
    if (last_interval) c.factors[next - 1] = 0.0f;
    restart(c, 2);
  }

  PLIANT_HOST_DEVICE void plan_chebyshev(const SceneState& scene,
                                         const IterationChange& judged) const {
    const auto& [c, rules] = scene;
    c.mode = StepControl::kChebyshev;
    c.slow = 1.0f;
    SpectralRadius radius(rules.rho_bound);
    radius.set(c.radius);
    if (rules.may_raise && c.accelerated > 0 &&
        judged.lags(radius, c.first_change, c.accelerated)) {
      radius.raise(judged.change / c.first_change, c.accelerated);
      c.radius = radius.value();
      ++c.restarts;
      restart(c, 1);
    }
    // What single precision leaves of ω is a radius that is off by 1e-7; each division of double
    // precision would take all blocks a sixth of a microsecond.
    const auto rho2 = static_cast<float>(c.radius * c.radius);
    for (int k = 0; k < next; ++k) {
      if (c.plain > 0 || c.radius == 0.0) {
        c.plain -= c.plain > 0 ? 1 : 0;
        c.factors[k] = 1.0f;
        continue;
      }
      if (c.accelerated == 0) c.first_change = judged.change;
      c.omega = chebyshev_factor(rho2, c.omega, c.accelerated == 0);
      c.factors[k] = c.omega;
      ++c.accelerated;
    }
  }
};

/// It, by a kernel of its own, a block a scene.
struct ControlStep {
  using Sums = SceneSum<kMeasures>;
  static constexpr int kPhases = Sums::kPhases;
  static constexpr int kThreads = Sums::kThreads;
  static constexpr int kSharedFloats = Sums::kSharedFloats;

  StepArrays arrays;
  const int* begins;  ///< first block of each scene, and the end
  StepDecision decide;

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0) return;
    auto* sums = reinterpret_cast<double*>(shared);
    Sums::add(phase, arrays.partial, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    double total[kMeasures];
    Sums::total(sums, total);
    // Numbers of its own: each look into the memory of all would cost as much as all of the rest.
    StepControl control = scene.control;
    const StepRules rules = scene.rules;
    decide({control, rules}, total);
    scene.control = control;
  }

  /// The state before the first iteration.
  PLIANT_HOST_DEVICE static void begin(StepControl& c, const StepRules& rules) {
    c = StepControl{};
    for (float& factor : c.factors) factor = 1.0f;
    c.slow = c.step = 1.0f;
    c.damped = rules.is_damped ? 1 : 0;
    c.done_at = rules.is_due ? -1 : 0;
    c.omega = 1.0f;
    c.radius = rules.rho;
    c.momentum = 1.0;
    c.plain = rules.delay;
    c.best_change = 1e300;
  }
};

/// Where the step ends, as a displacement from the prediction [m]; not a number where iterations
/// left all bounds, for the host's check to find.
struct StepResult {
  StepArrays arrays;
  Float4* displacement;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const SceneState scene = arrays.scene_with(i / arrays.block);
    const StepControl& c = scene.control;
    Float3 end = scene.rules.quantum * (arrays.ended(c, i) - arrays.predicted[i]);
    if (c.result == StepControl::kNotFinite) end.x = end.y = end.z = NAN;
    displacement[i] = with_w(end, 0.0f);
  }
};

/// The first iterate and the state of control of each scene. Nothing of a step before is taken for
/// a version of something in this one (mailbox.h).
struct BeginStep {
  StepArrays arrays;
  const Fixed* start;
  int scenes;
  Fixed* mailboxes;  ///< or null
  int packets;       ///< there

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Fixed x = start[i], none = {0, 0, 0, version_bits(0)};
    arrays.x[0][i] = {x.x, x.y, x.z, none.w};
    if (i < scenes) ControlStep::begin(arrays.control[i], arrays.rules[i]);
    if (mailboxes == nullptr) return;
    arrays.x[1][i] = none;
    if (i < packets) mailboxes[i] = none;
  }
};

/// The state of control alone.
struct BeginControl {
  StepArrays arrays;

  PLIANT_HOST_DEVICE void operator()(int number) const {
    ControlStep::begin(arrays.control[number], arrays.rules[number]);
  }
};

}  // namespace pliant
