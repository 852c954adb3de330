#pragma once

#include "cuda/solvers/matrix/quasi_newton_state.h"
#include "cuda/solvers/sums.h"

/// The direction of an iteration of L-BFGS by the two-loop recursion (Nocedal and Wright 2006,
/// algorithm 7.4), as functions of one thread. Its scalar products are summed all at once, those of
/// pairs with each other beside them: two sums over all particles instead of one a product. The
/// first inverse Hessian is a fixed polynomial of the projective matrix, in the directions that
/// contacts leave free.
namespace pliant {

/// Whether a scene looks for a new direction now.
PLIANT_HOST_DEVICE inline bool seeks(const SceneState& scene, const QuasiNewtonState& state) {
  return scene.control.done_at < 0 && state.is_retry == 0;
}

/// What contacts hold now. Pairs stay where that changes, on a fine mesh somewhere in nearly every
/// iteration: they are what the freedom of their time told of the Hessian, and the direction is one
/// of the present freedom.
struct HoldStep {
  StepArrays arrays;
  ContactsView contacts;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    if (!seeks(arrays.scene(number), view.states[number]) || arrays.mobility[i] == 0.0f) return;
    view.holds[i] = hold_of(contacts, i);
  }
};

/// The new pair, and its products with the others and with the forces.
struct PairProducts {
  static constexpr int kPhases = 3;
  StepArrays arrays;
  ContactsView contacts;
  QuasiNewtonView view;

  /// s_i · b, s_new · y_i and s_i · y_new of slots i, then s_new · s_new and y_new · y_new.
  PLIANT_HOST_DEVICE static constexpr int count(int slots) { return 3 * slots + 2; }

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const int number = arrays.number_of(block);
    const SceneState scene = arrays.scene(number);
    const QuasiNewtonState& state = view.states[number];
    if (!seeks(scene, state)) return;
    const WideBlockSum sums = {count(view.slots()), arrays.block};
    if (phase == 0) {
      float* own = shared + thread * sums.count;
      sums.clear(own);
      const int i = block * arrays.block + thread;
      if (i < arrays.particles && arrays.mobility[i] > 0.0f) measure(scene, state, i, own);
    } else if (phase == 1) {
      sums.first(shared, thread);
    } else {
      sums.second(shared, thread, view.partial + block * sums.count);
    }
  }

 private:
  PLIANT_HOST_DEVICE void measure(const SceneState& scene, const QuasiNewtonState& state, int i,
                                  float* sums) const {
    const int slots = view.slots(), now = scene.control.best, before = 1 - now;
    const Float4 hold = view.holds[i];
    const Float3 r = view.forces[now][i].xyz();
    int active;
    const Float3 b = Hold::project(hold, r + contact_force(contacts, i, active));
    Float3 s = {0.0f, 0.0f, 0.0f}, y = s;
    if (state.has_moved) {
      const Float3 displacement = arrays.saved[now][i] - arrays.saved[before][i];
      s = Hold::project(hold, scene.rules.quantum * displacement);
      y = Hold::project(hold, view.forces[before][i].xyz() - r);
      view.s[state.next * view.places + i] = with_w(s, 0.0f);
      view.y[state.next * view.places + i] = with_w(y, 0.0f);
      sums[state.next] = dot(s, b);
      sums[slots + state.next] = dot(s, y);
      sums[3 * slots] = dot(s, s);
      sums[3 * slots + 1] = dot(y, y);
    }
    for (int k = 1; k <= state.held; ++k) {
      const int slot = (state.next - k + slots) % slots;
      const Float3 other = view.s[slot * view.places + i].xyz();
      sums[slot] = dot(other, b);
      if (!state.has_moved) continue;
      sums[slots + slot] = dot(s, view.y[slot * view.places + i].xyz());
      sums[2 * slots + slot] = dot(other, y);
    }
  }
};

/// α of the first loop. A block a scene.
struct FirstLoop {
  static constexpr int kPhases = WideSceneSum::kPhases;
  // Pairs with less curvature than this, relative to their lengths, say nothing of the Hessian.
  static constexpr double kLeastCurvature = 1e-9;
  StepArrays arrays;
  QuasiNewtonView view;
  const int* begins;  ///< first block of each scene, and the end

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    QuasiNewtonState& state = view.states[number];
    if (!seeks(arrays.scene(number), state)) return;
    auto* sums = reinterpret_cast<double*>(shared);
    const WideSceneSum all = {PairProducts::count(view.slots())};
    all.add(phase, view.partial, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    const double* total = WideSceneSum::totals(sums);
    if (state.has_moved) remember(state, total);
    state.has_moved = 0;
    state.is_plain = state.held == 0 ? 1 : 0;
    recur(state, total);
  }

 private:
  PLIANT_HOST_DEVICE void remember(QuasiNewtonState& state, const double* total) const {
    const int slots = view.slots(), slot = state.next;
    const double curvature = total[slots + slot];
    const double lengths = std::sqrt(total[3 * slots] * total[3 * slots + 1]);
    if (!(curvature > kLeastCurvature * lengths)) return;
    for (int k = 0; k < slots; ++k) {
      state.products[slot][k] = total[slots + k];
      if (k != slot) state.products[k][slot] = total[2 * slots + k];
    }
    state.next = (slot + 1) % slots;
    state.held = state.held < view.history ? state.held + 1 : view.history;
  }
  PLIANT_HOST_DEVICE void recur(QuasiNewtonState& state, const double* total) const {
    const int slots = view.slots();
    double alpha[QuasiNewtonState::kMostSlots];
    for (int k = 0; k < slots; ++k) state.alpha[k] = 0.0f;
    for (int k = 1; k <= state.held; ++k) {  // the newest first
      const int i = (state.next - k + slots) % slots;
      double product = total[i];
      for (int m = 1; m < k; ++m) {
        const int j = (state.next - m + slots) % slots;
        product -= alpha[j] * state.products[i][j];
      }
      alpha[i] = product / state.products[i][i];
      state.alpha[i] = static_cast<float>(alpha[i]);
    }
  }
};

/// q = b − Σ α y, and the first sweep.
struct BeginSweeps {
  StepArrays arrays;
  ContactsView contacts;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    const SceneState scene = arrays.scene(number);
    const QuasiNewtonState& state = view.states[number];
    if (!seeks(scene, state)) return;
    Float3 q = {0.0f, 0.0f, 0.0f};
    if (arrays.mobility[i] > 0.0f) {
      int active;
      q = view.forces[scene.control.best][i].xyz() + contact_force(contacts, i, active);
      q = Hold::project(view.holds[i], q);
      for (int slot = 0; slot < view.slots(); ++slot) {
        if (state.alpha[slot] == 0.0f) continue;
        q -= state.alpha[slot] * view.y[slot * view.places + i].xyz();
      }
    }
    view.wanted[i] = with_w(q, 0.0f);
    view.found[0][i] = with_w((state.pull[0] * arrays.mobility[i]) * q, 0.0f);
    view.found[1][i] = {0.0f, 0.0f, 0.0f, 0.0f};
  }
};

/// One more of Chebyshev's sweeps.
struct SweepMatrix {
  StepArrays arrays;
  MatrixView matrix;
  QuasiNewtonView view;
  int sweep;  ///< its number, from 1 on

  struct Found {
    const Float4* z;
    PLIANT_HOST_DEVICE const Float4& load(int i) const { return z[i]; }
    PLIANT_HOST_DEVICE static Float3 of(const Float4& loaded) { return loaded.xyz(); }
  };

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    const QuasiNewtonState& state = view.states[number];
    const float mobility = arrays.mobility[i];
    if (mobility == 0.0f || !seeks(arrays.scene(number), state)) return;
    const Float4* from = view.found[(sweep + 1) % 2];
    Float4& to = view.found[sweep % 2][i];
    const Float3 z = from[i].xyz();
    const Float3 left = view.wanted[i].xyz() - product_of_row(matrix, arrays, i, z, Found{from});
    const Float3 pulled = Hold::project(view.holds[i], left);
    const Float3 next =
        z + state.momentum[sweep] * (z - to.xyz()) + (state.pull[sweep] * mobility) * pulled;
    to = with_w(next, 0.0f);
  }
};

/// y_i · z of slots i.
struct FoundProducts {
  static constexpr int kPhases = 3;
  StepArrays arrays;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const int number = arrays.number_of(block);
    const QuasiNewtonState& state = view.states[number];
    if (!seeks(arrays.scene(number), state)) return;
    const WideBlockSum sums = {view.slots(), arrays.block};
    if (phase == 1) return sums.first(shared, thread);
    if (phase == 2) return sums.second(shared, thread, view.partial + block * sums.count);
    float* own = shared + thread * sums.count;
    sums.clear(own);
    const int i = block * arrays.block + thread;
    if (i >= arrays.particles || arrays.mobility[i] == 0.0f) return;
    const Float3 z = view.found[(view.sweeps + 1) % 2][i].xyz();
    for (int k = 1; k <= state.held; ++k) {
      const int slot = (state.next - k + sums.count) % sums.count;
      own[slot] = dot(view.y[slot * view.places + i].xyz(), z);
    }
  }
};

/// What of each s the direction takes. A block a scene.
struct SecondLoop {
  static constexpr int kPhases = WideSceneSum::kPhases;
  StepArrays arrays;
  QuasiNewtonView view;
  const int* begins;

  PLIANT_HOST_DEVICE void operator()(int phase, int number, int thread, float* shared) const {
    QuasiNewtonState& state = view.states[number];
    if (!seeks(arrays.scene(number), state)) return;
    auto* sums = reinterpret_cast<double*>(shared);
    const int slots = view.slots();
    const WideSceneSum all = {slots};
    all.add(phase, view.partial, begins[number], begins[number + 1], thread, sums);
    if (phase != 2 || thread != 0) return;
    const double* total = WideSceneSum::totals(sums);
    double share[QuasiNewtonState::kMostSlots];
    for (int k = 0; k < slots; ++k) state.share[k] = 0.0f;
    for (int k = state.held; k >= 1; --k) {  // the oldest first
      const int i = (state.next - k + slots) % slots;
      double product = total[i];
      for (int m = state.held; m > k; --m) {
        const int j = (state.next - m + slots) % slots;
        product += share[j] * state.products[j][i];
      }
      share[i] = state.alpha[i] - product / state.products[i][i];
      state.share[i] = static_cast<float>(share[i]);
    }
  }
};

/// The direction d = z + Σ share s, and where the step tries to go.
struct TrialStep {
  StepArrays arrays;
  QuasiNewtonView view;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = arrays.number_of(i / arrays.block);
    const SceneState scene = arrays.scene(number);
    if (scene.control.done_at >= 0) return;
    const QuasiNewtonState& state = view.states[number];
    if (state.is_retry == 0) view.wanted[i] = with_w(direction(state, i), 0.0f);
    const Fixed& from = arrays.saved[scene.control.best][i];
    Fixed& to = arrays.saved[1 - scene.control.best][i];
    to = moved(from, (state.step / scene.rules.quantum) * view.wanted[i].xyz());
  }

 private:
  PLIANT_HOST_DEVICE Float3 direction(const QuasiNewtonState& state, int i) const {
    if (arrays.mobility[i] == 0.0f) return {0.0f, 0.0f, 0.0f};
    Float3 d = view.found[(view.sweeps + 1) % 2][i].xyz();
    for (int slot = 0; slot < view.slots(); ++slot) {
      if (state.share[slot] == 0.0f) continue;
      d += state.share[slot] * view.s[slot * view.places + i].xyz();
    }
    return Hold::project(view.holds[i], d);
  }
};

}  // namespace pliant
