#pragma once

#include "cuda/solvers/resident_run/balance_answer.h"
#include "cuda/solvers/resident_run/matrix6.h"

namespace pliant {

/// The search for a component's motion z, by Newton's method:
///   A z = s + Jᵀ λ(z),
/// A the component's inertia over h², s all other forces and λ what its contacts answer. Friction
/// whose bound follows the normal force is no gradient: where steps do not lessen the residual,
/// bounds are given, so that a potential is to be least, and follow from one search to the next. It
/// ends with its best trial: where none is good, velocities still have the momentum of the forces
/// that are told.
struct MotionSearch {
  bool is_done, is_first, is_coulomb;
  int corrections;
  double inertia[6], mass;  ///< over h²: xx, yy, zz, xy, xz, yz [N m], and [N/m]
  double other[6], size, radius;
  Fixed origin;
  Double3 center;
  double motion[6], from[6], step[6], best[6];
  double bounding[6];  ///< the motion whose normal forces bound friction, where bounds are given
  double share, error, slope, potential;
  double best_error;
  double alone;   ///< φ without elements where contacts move their particles alone [N m]
  double gained;  ///< and by the best motion, less the work of friction that it saves

  PLIANT_HOST_DEVICE void begin(const Fixed& first) {
    is_done = false;
    is_first = is_coulomb = true;
    corrections = 0;
    origin = first;
    center = Double3{0.0, 0.0, 0.0};
    gained = alone = 0.0;
    best_error = 1e300;
    for (int k = 0; k < 6; ++k) motion[k] = best[k] = bounding[k] = 0.0;
  }
  PLIANT_HOST_DEVICE BalanceMotion found() const { return motion_of(motion); }
  PLIANT_HOST_DEVICE BalanceMotion bounds() const { return motion_of(bounding); }
  PLIANT_HOST_DEVICE Matrix6 matrix() const {
    Matrix6 a = {};
    for (int k = 0; k < 3; ++k) a(k, k) = mass;
    const int index[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a(3 + i, 3 + j) = inertia[index[i][j]];
    }
    return a;
  }
  /// Where it is better to let the particles in contact give way alone, whatever that costs of
  /// elements' energy, the component stays.
  PLIANT_HOST_DEVICE void stay_unless_better() {
    if (gained < alone) return;
    for (double& value : motion) value = 0.0;
  }

  /// With the best motion so far.
  PLIANT_HOST_DEVICE void end() {
    is_done = true;
    for (int k = 0; k < 6; ++k) motion[k] = best[k];
  }

  /// Looks at what contacts answer to the present motion and goes on to the next one, or ends.
  PLIANT_HOST_DEVICE void look(const ContactAnswer& answer, bool is_last, double tolerance) {
    double residual[6];
    const double inertial = inertial_residual(residual), now = inertial + answer.potential;
    for (int k = 0; k < 6; ++k) residual[k] += answer.force[k];
    double missed = 0.0;
    for (int k = 0; k < 6; ++k) {
      missed = greater(missed, std::fabs(residual[k]) / (k < 3 ? 1.0 : radius));
    }
    const bool is_met = missed <= tolerance * (size + answer.size);
    // Given bounds are those of the present motion where a search begins.
    if (is_coulomb || is_first) keep_best(missed, inertial - answer.saved);
    if (is_last || (is_met && (is_coulomb || is_first))) return end();
    if (!is_first && !is_better(missed, now)) {
      share *= 0.5;
      if (share < (is_coulomb ? kSmallest : kSmallestConvex)) return give_bounds();
      return place();
    }
    if (is_met || (is_coulomb && corrections == kMost)) return give_bounds();
    is_first = false;
    ++corrections;
    error = missed;
    potential = now;
    correct(answer, residual);
  }

 private:
  static constexpr int kMost = 8;
  static constexpr double kSmallest = 0.1, kSmallestConvex = 1e-6, kArmijo = 1e-4;
  static constexpr double kRoundOff = 1e-13;

  PLIANT_HOST_DEVICE BalanceMotion motion_of(const double* z) const {
    return {origin, center, Double3{z[0], z[1], z[2]}, Double3{z[3], z[4], z[5]}};
  }
  PLIANT_HOST_DEVICE void keep_best(double missed, double gained_now) {
    if (!(missed < best_error)) return;
    best_error = missed;
    gained = gained_now;
    for (int k = 0; k < 6; ++k) best[k] = motion[k];
  }
  PLIANT_HOST_DEVICE void give_bounds() {
    if (is_coulomb) {
      for (int k = 0; k < 6; ++k) motion[k] = best[k];
    }
    is_coulomb = false;
    is_first = true;
    for (int k = 0; k < 6; ++k) bounding[k] = motion[k];
  }
  PLIANT_HOST_DEVICE bool is_better(double missed, double now) const {
    if (is_coulomb) return missed < error;
    return now <= potential - kArmijo * share * slope + kRoundOff * std::fabs(potential);
  }
  PLIANT_HOST_DEVICE void place() {
    for (int k = 0; k < 6; ++k) motion[k] = from[k] + share * step[k];
  }
  /// s − A z; returns ½ zᵀA z − sᵀz.
  PLIANT_HOST_DEVICE double inertial_residual(double* residual) const {
    const Matrix6 a = matrix();
    double sum = 0.0;
    for (int i = 0; i < 6; ++i) {
      double held = 0.0;
      for (int j = 0; j < 6; ++j) held += a(i, j) * motion[j];
      residual[i] = other[i] - held;
      sum += (0.5 * held - other[i]) * motion[i];
    }
    return sum;
  }
  PLIANT_HOST_DEVICE void correct(const ContactAnswer& answer, const double* residual) {
    Matrix6 a = matrix();
    for (int k = 0; k < 36; ++k) a.m[k] += answer.shape[k];
    for (int k = 0; k < 6; ++k) step[k] = residual[k];
    solve(a, step);
    slope = 0.0;
    for (int k = 0; k < 6; ++k) {
      slope += residual[k] * step[k];
      from[k] = motion[k];
    }
    share = 1.0;
    place();
  }
};

/// What the contacts of each run answer to the motion that is tried, by a block of its own.
struct SumAnswers {
  static constexpr int kThreads = BalanceComponents::kRun;
  static constexpr int kHalvings = BalanceComponents::kHalvings;
  static constexpr int kPhases = kHalvings + 2;
  static constexpr int kNumbers = sizeof(ContactAnswer) / sizeof(double);
  static constexpr int kSharedFloats = 2 * kNumbers * kThreads;

  BalanceContacts contacts;

  PLIANT_HOST_DEVICE void operator()(int phase, int run, int thread, float* shared) const {
    const BalanceComponents& components = contacts.components;
    const int count = components.touched_count[run];
    const MotionSearch& search = components.searches[components.of_run[run]];
    if (search.is_done) return;
    auto* numbers = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      clear(numbers, thread);
      add(search, run, thread, numbers);
    } else if (phase <= kHalvings) {
      if (count > kThreads >> phase) halve(numbers, phase, thread, kNumbers);
    } else {
      for (int k = thread; k < kNumbers; k += kThreads) {
        components.answers[run * kNumbers + k] = numbers[k];
      }
    }
  }
  PLIANT_HOST_DEVICE static void clear(double* numbers, int thread) {
    for (int k = 0; k < kNumbers; ++k) numbers[thread * kNumbers + k] = 0.0;
  }
  /// What the contacts of a run's `thread`th touched member answer.
  PLIANT_HOST_DEVICE void add(const MotionSearch& search, int run, int thread,
                              double* numbers) const {
    const BalanceComponents& components = contacts.components;
    if (thread >= components.touched_count[run]) return;
    const int i = components.touched[run * kThreads + thread];
    auto& sum = *reinterpret_cast<ContactAnswer*>(numbers + thread * kNumbers);
    const BalanceMotion motion = search.found(), bounds = search.bounds();
    contacts.for_each(i, [&](int slot) {
      AnsweredContact a = contacts.answered(motion, i, slot);
      if (!search.is_coulomb) a.bound = contacts.answered(bounds, i, slot).bound;
      const double slip = norm(in_double(components.rows[slot].xyz()));
      sum.add(a, slip, search.is_coulomb ? contacts.resident.contacts[slot].slip.w : 0.0);
    });
  }
  /// Threads add the second half of what is left to the first one.
  PLIANT_HOST_DEVICE static void halve(double* numbers, int phase, int thread, int count) {
    const int half = (kThreads >> phase) * count;
    for (int k = thread; k < half; k += kThreads) numbers[k] += numbers[half + k];
  }
};

/// Sums of `numbers` of each run over the runs of a component, in a fixed order: threads take a
/// number each, several of them the same one of every so many runs, and then add up.
struct RunSum {
  static constexpr int kThreads = 384;
  int numbers;

  PLIANT_HOST_DEVICE int groups() const { return kThreads / numbers; }
  PLIANT_HOST_DEVICE void first(const double* of_runs, int begin, int end, int thread,
                                double* sums) const {
    if (thread >= groups() * numbers) return;
    const int number = thread % numbers;
    double sum = 0.0;
    for (int run = begin + thread / numbers; run < end; run += groups()) {
      sum += of_runs[run * numbers + number];
    }
    sums[thread] = sum;
  }
  /// Into the first `numbers` places.
  PLIANT_HOST_DEVICE void second(int thread, double* sums) const {
    if (thread >= numbers) return;
    double sum = 0.0;
    for (int group = 0; group < groups(); ++group) sum += sums[group * numbers + thread];
    sums[thread] = sum;
  }
};

/// Begins the search of each component, by a block of its own, with the sums of its runs.
struct BeginSearch {
  static constexpr int kThreads = RunSum::kThreads;
  static constexpr int kPhases = 3;
  static constexpr int kSharedFloats = 2 * kThreads;

  StepArrays arrays;
  ResidentArrays resident;
  BalanceComponents components;
  bool compares;  ///< finds what velocities lack with the forces as they are

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    constexpr RunSum kSum = {BalanceComponents::kNumbers};
    auto* numbers = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      kSum.first(components.sums, components.run_begins[block], components.run_begins[block + 1],
                 thread, numbers);
    } else if (phase == 1) {
      kSum.second(thread, numbers);
    } else if (thread == 0) {
      MotionSearch& search = components.searches[block];
      begin(search, block, numbers);
      if (compares) components.missed[block] = search.found();
    }
  }

 private:
  PLIANT_HOST_DEVICE static Double3 three(const double* from) {
    return Double3{from[0], from[1], from[2]};
  }
  PLIANT_HOST_DEVICE void begin(MotionSearch& search, int block, const double* sums) const {
    search.begin(resident.now[components.first_of(block)]);
    const double mass = sums[BalanceComponents::kMass];
    search.is_done = !(mass > 0.0);  // it is not due, or its scene touches nothing
    if (search.is_done) return;
    search.mass = mass;
    search.center = three(sums + BalanceComponents::kFirst) / mass;
    set_inertia(search, sums);
    Double3 force = three(sums + BalanceComponents::kForce),
            torque = three(sums + BalanceComponents::kTorque);
    if (compares) {
      force += three(sums + BalanceComponents::kPushed);
      torque += three(sums + BalanceComponents::kTwisted);
    }
    torque = torque - cross(search.center, force);
    const double other[6] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (int k = 0; k < 6; ++k) search.other[k] = other[k];
    search.size = sums[BalanceComponents::kSize];
    search.alone = sums[BalanceComponents::kAlone];
    const bool touches = sums[BalanceComponents::kTouched] > 0.0;
    if (touches && !compares) return;
    for (int k = 0; k < 6; ++k) search.motion[k] = other[k];
    solve(search.matrix(), search.motion);
    search.is_done = true;
    if (compares) lose_if_too_much(search, block, sums);
  }
  PLIANT_HOST_DEVICE static void set_inertia(MotionSearch& search, const double* sums) {
    const double* second = sums + BalanceComponents::kSecond;
    const Double3 c = search.center;
    const double m = search.mass;
    const double central[6] = {second[0] - m * c.x * c.x, second[1] - m * c.y * c.y,
                               second[2] - m * c.z * c.z, second[3] - m * c.x * c.y,
                               second[4] - m * c.x * c.z, second[5] - m * c.y * c.z};
    const double trace = central[0] + central[1] + central[2];
    for (int k = 0; k < 3; ++k) search.inertia[k] = trace - central[k];
    for (int k = 3; k < 6; ++k) search.inertia[k] = -central[k];
    search.radius = std::sqrt(greater(trace / m, 1e-300));
  }
  /// What forces tell that press a stiff body from two sides and did not converge is none.
  PLIANT_HOST_DEVICE void lose_if_too_much(MotionSearch& search, int block,
                                           const double* sums) const {
    double missed = 0.0;
    for (int k = 0; k < 6; ++k) missed += search.other[k] * search.motion[k];
    if (missed <= sums[BalanceComponents::kMoved]) return;
    for (double& value : search.motion) value = 0.0;
    resident.tally[scene_of(arrays, components.first_of(block))].lost = 1;
  }
};

/// Looks at what the contacts of each component answer, by a block of its own.
struct LookAtAnswers {
  static constexpr int kThreads = RunSum::kThreads;
  static constexpr int kPhases = 3;
  static constexpr int kSharedFloats = 2 * kThreads;

  BalanceComponents components;
  bool starts;       ///< before the iterations
  double tolerance;  ///< of the residual, as a share of all forces

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    constexpr RunSum kSum = {SumAnswers::kNumbers};
    MotionSearch& search = components.searches[block];
    // Nobody changes it before the last phase.
    if (search.is_done) return;
    auto* numbers = reinterpret_cast<double*>(shared);
    if (phase == 0) {
      kSum.first(components.answers, components.run_begins[block], components.run_begins[block + 1],
                 thread, numbers);
    } else if (phase == 1) {
      kSum.second(thread, numbers);
    } else if (thread == 0) {
      search.look(*reinterpret_cast<const ContactAnswer*>(numbers), false, tolerance);
      if (search.is_done && starts) search.stay_unless_better();
    }
  }
};

/// All other trials of the few components whose search takes long, each by a block of its own.
/// Whoever ends far from balance is told.
struct EndSearch {
  static constexpr int kThreads = BalanceComponents::kRun;
  static constexpr int kHalvings = BalanceComponents::kHalvings;
  static constexpr int kPhases = kHalvings + 2;
  static constexpr int kSharedFloats = SumAnswers::kSharedFloats;
  static constexpr int kTrials = 60;
  static constexpr double kFar = 1e-2;  // out of balance, as a share of all forces

  SumAnswers answers;
  bool starts;
  double tolerance;

  PLIANT_HOST_DEVICE bool goes_on(int /*turn*/, int block) const {
    return !answers.contacts.components.searches[block].is_done;
  }
  PLIANT_HOST_DEVICE void operator()(int turn, int phase, int block, int thread,
                                     float* shared) const {
    const BalanceComponents& components = answers.contacts.components;
    MotionSearch& search = components.searches[block];
    auto* numbers = reinterpret_cast<double*>(shared);
    const int first = components.run_begins[block], end = components.run_begins[block + 1];
    if (phase == 0) {
      SumAnswers::clear(numbers, thread);
      for (int run = first; run < end; ++run) answers.add(search, run, thread, numbers);
    } else if (phase <= kHalvings) {
      SumAnswers::halve(numbers, phase, thread, SumAnswers::kNumbers);
    } else if (thread == 0) {
      const auto& answer = *reinterpret_cast<const ContactAnswer*>(numbers);
      search.look(answer, turn + 1 == kTrials, tolerance);
      if (search.is_done) finish(search, block);
    }
  }

 private:
  PLIANT_HOST_DEVICE void finish(MotionSearch& search, int block) const {
    if (starts) return search.stay_unless_better();
    if (search.best_error <= kFar * search.size) return;
    const BalanceContacts& of = answers.contacts;
    of.resident.tally[scene_of(of.arrays, of.components.first_of(block))].unbalanced = 1;
  }
};

}  // namespace pliant
