#pragma once

#include "cuda/solvers/series_step.h"
#include "pliant/math/double3.h"
#include "pliant/solvers/contact_response.h"
#include "pliant/solvers/rigid_mode.h"

/// The rigid motion that forces demand of each connected component (ImpulseBalance), in a series.
namespace pliant {

/// What contact_response.h reads of a contact.
struct BalanceRow {
  Eigen::Vector3d normal, slip, friction_force;
  double gap, friction, normal_force;
  double adhesion;

  PLIANT_HOST_DEVICE double friction_bound(double normal_force_now) const {
    const double pressing = normal_force_now + adhesion;
    return pressing > 0.0 ? friction * pressing : 0.0;
  }
  PLIANT_HOST_DEVICE Eigen::Vector3d force() const {
    return normal_force * normal + friction_force;
  }
};

PLIANT_HOST_DEVICE inline Eigen::Vector3d in_double(const Float3& v) {
  return Eigen::Vector3d(v.x, v.y, v.z);
}
PLIANT_HOST_DEVICE inline Eigen::Vector3d difference(const Fixed& a, const Fixed& b) {
  return Eigen::Vector3d(a.x - b.x, a.y - b.y, a.z - b.z);
}
PLIANT_HOST_DEVICE inline Float3 in_single(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// By a `way` in quanta of more digits than single precision has.
PLIANT_HOST_DEVICE inline Fixed moved_far(const Fixed& from, const Eigen::Vector3d& way) {
  const auto whole = [](double value) {
    constexpr double kMost = 1073741824.0;
    // What is no number becomes one that no bound lets pass.
    if (!(value > -kMost)) return -1073741824;
    return value < kMost ? static_cast<int>(rint(value)) : 1073741824;
  };
  return {from.x + whole(way[0]), from.y + whole(way[1]), from.z + whole(way[2]), from.w};
}

/// Contacts of particle i, those that are there.
struct BalanceContacts {
  static constexpr float kFar = 1e29f;  ///< no gap
  SeriesArrays series;

  PLIANT_HOST_DEVICE bool is_there(int i, int k) const {
    return series.contacts[series.slots * i + k].plane.w < kFar;
  }
  /// Contacts of a particle share its mobility, so that together they do not move it too far (mass
  /// splitting; Tonge et al. 2012).
  PLIANT_HOST_DEVICE int count(int i) const {
    if (series.slots == 0 || series.first[i] < 0) return 0;
    int count = 0;
    for (int k = 0; k < series.slots; ++k) count += is_there(i, k) ? 1 : 0;
    return count;
  }
  PLIANT_HOST_DEVICE BalanceRow row(int i, int k, const Fixed& x, double quantum) const {
    const DeviceContact& contact = series.contacts[series.slots * i + k];
    const DeviceContactForce& force = series.forces[series.slots * i + k];
    const Eigen::Vector3d way = quantum * difference(x, series.predicted[i]);
    BalanceRow row;
    row.normal = in_double(contact.plane.xyz());
    row.gap = contact.plane.w + row.normal.dot(way);
    const Eigen::Vector3d slip = in_double(contact.slip.xyz()) + way;
    row.slip = slip - row.normal.dot(slip) * row.normal;
    row.friction = contact.slip.w;
    row.adhesion = 0.0;
    row.normal_force = force.normal;
    row.friction_force = in_double(force.friction);
    return row;
  }
};

/// Components that take part, as views of the executor's memory.
struct BalanceComponents {
  int count = 0;
  const int* begins = nullptr;
  const int* members = nullptr;  ///< places
};

/// What a component's block shares from one turn to the next.
struct BalanceState {
  enum Stage : int { kTurn, kMode, kTrial, kTake, kDone };
  enum Deed : int { kNothing, kSpin, kBoundsOfRows, kBoundsOfForces, kMove };

  int stage, deed;
  int round;
  rigid::Turn turn;
  rigid::Mode mode;
  rigid::Vector6 balance;         // with the forces of contacts, as they were [N]
  rigid::Vector6 motion;          // [m]
  rigid::Vector6 contact_motion;  // to which contacts answer
  bool has_contacts;
  // Of Newton's search.
  rigid::Vector6 from, step;
  bool is_coulomb, is_first;
  int corrections, disks;
  double share, error, slope, before;
};

/// The search for a component's motion and the forces of its contacts, by one thread: as
/// ImpulseBalance, whose constants these are.
struct BalanceSearch {
  static constexpr int kMaxNewton = 12, kMaxConvexNewton = 40;
  static constexpr int kDisks = 4;
  static constexpr double kArmijo = 1e-4, kPotentialRoundOff = 1e-14;
  static constexpr double kSmallestStep = 1e-3, kSmallestConvexStep = 1e-9;
  static constexpr double kLastTolerance = 1e-12, kTolerance = 1e-6;

  /// Of contacts at the present motion.
  struct Trial {
    Eigen::Vector3d force, turning;
    double potential;
    double stiffness[36];
  };

  BalanceState& state;
  double tolerance;

  PLIANT_HOST_DEVICE void begin() const {
    for (int k = 0; k < 6; ++k) state.motion[k] = 0.0;
    state.is_coulomb = true;
    begin_newton();
    state.stage = BalanceState::kTrial;
    state.deed = BalanceState::kNothing;
  }

  /// Looks at a trial and says what comes next.
  PLIANT_HOST_DEVICE void look(const Trial& trial) const {
    state.deed = BalanceState::kNothing;
    rigid::Vector6 residual = rest();
    for (int k = 0; k < 3; ++k) {
      residual[k] += trial.force[k];
      residual[3 + k] += trial.turning[k];
    }
    double error = 0.0;
    for (int k = 0; k < 6; ++k) error = greater(error, std::fabs(residual[k]));
    const double potential = trial.potential + inertial_potential();
    if (!state.is_first) {
      const double smallest = state.is_coulomb ? kSmallestStep : kSmallestConvexStep;
      if (state.share < smallest) return end(false);
      const double slack = kPotentialRoundOff * std::fabs(state.before);
      const bool is_lower =
          state.is_coulomb
              ? error < state.error
              : potential <= state.before - kArmijo * state.share * state.slope + slack;
      if (!is_lower) {
        state.share *= 0.5;
        return place();
      }
      ++state.corrections;
    }
    state.is_first = false;
    state.error = error;
    const bool is_met = error <= tolerance * state.mode.size;
    const int most = state.is_coulomb ? kMaxNewton : kMaxConvexNewton;
    if (is_met || !(error < 1e300) || state.corrections == most) return end(is_met);
    correct(trial, residual, potential);
  }

  PLIANT_HOST_DEVICE void correct(const Trial& trial, const rigid::Vector6& residual,
                                  double potential) const {
    rigid::Matrix6 matrix = state.mode.inertia;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) matrix(i, j) += trial.stiffness[6 * i + j];
    }
    rigid::Vector6 right = residual;
    state.step = rigid::solve(matrix, right);
    state.slope = 0.0;
    for (int k = 0; k < 6; ++k) state.slope += residual[k] * state.step[k];
    state.before = potential;
    state.from = state.motion;
    state.share = 1.0;
    place();
  }

 private:
  PLIANT_HOST_DEVICE void begin_newton() const {
    state.is_first = true;
    state.corrections = 0;
  }
  PLIANT_HOST_DEVICE void place() const {
    for (int k = 0; k < 6; ++k) state.motion[k] = state.from[k] + state.share * state.step[k];
  }
  /// What is left of all forces but those of contacts.
  PLIANT_HOST_DEVICE rigid::Vector6 rest() const {
    rigid::Vector6 rest = state.mode.unbalanced;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) rest[i] -= state.mode.inertia(i, j) * state.motion[j];
    }
    return rest;
  }
  PLIANT_HOST_DEVICE double inertial_potential() const {
    const rigid::Vector6 left = rest();
    double sum = 0.0;
    // ½ xᵀAx − bᵀx = −½ (b + (b − Ax))ᵀx
    for (int k = 0; k < 6; ++k) sum -= 0.5 * (state.mode.unbalanced[k] + left[k]) * state.motion[k];
    return sum;
  }
  /// One search is over. Friction that follows the normal force need not have a solution that is
  /// found so. With disks that are given there is always one; they follow from one to the next.
  PLIANT_HOST_DEVICE void end(bool is_met) const {
    if (state.is_coulomb && !is_met) {
      state.is_coulomb = false;
      state.disks = 0;
      for (int k = 0; k < 6; ++k) state.motion[k] = 0.0;
      state.deed = BalanceState::kBoundsOfRows;
      return begin_newton();
    }
    if (!state.is_coulomb && ++state.disks < kDisks) {
      state.deed = BalanceState::kBoundsOfForces;
      return begin_newton();
    }
    state.stage = BalanceState::kTake;
  }
};

/// All of it for each component, by a block of its own: in each turn the threads add up what the
/// stage needs, one of them decides, and all do what it decided.
struct BalanceStep {
  static constexpr int kThreads = 128;
  static constexpr int kHalvings = 7;  ///< of the threads that add up
  static constexpr int kPhases = kHalvings + 3;
  static constexpr int kRounds = 6;
  static_assert(1 << kHalvings == kThreads, "all threads are added up");

  /// About the first member: of particles and of contacts.
  struct ModeSums {
    rigid::Sums particles;
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
    double size = 0.0;
    double contacts = 0.0, missed = 0.0;  // how many are there, and do not hold
  };
  struct TakenSums {
    Eigen::Vector3d force, turning;  // of contacts
    Eigen::Vector3d way, spin;       // momentum over h that their local displacements would hold
  };
  static constexpr int kNumbers = 44;
  static_assert(sizeof(ModeSums) <= kNumbers * sizeof(double), "all sums have room");
  static_assert(sizeof(BalanceSearch::Trial) <= kNumbers * sizeof(double), "all sums have room");
  static constexpr int kStateFloats = (sizeof(BalanceState) + 15) / 16 * 4;
  static constexpr int kSharedFloats = kStateFloats + 2 * kNumbers * kThreads;

  StepArrays arrays;
  SeriesArrays series;
  BalanceComponents components;
  Fixed* x;
  bool is_last;  ///< after the iterations, else before them
  double* bounds;

  PLIANT_HOST_DEVICE bool goes_on(int turn, int block, const float* shared) const {
    if (turn > 0) return state_of(shared).stage != BalanceState::kDone;
    const SceneState scene = arrays.scene(scene_of(arrays, first_of(block)));
    if (!scene.rules.is_due) return false;
    return !is_last || scene.control.result != StepControl::kNotFinite;
  }

  PLIANT_HOST_DEVICE void operator()(int turn, int phase, int block, int thread,
                                     float* shared) const {
    BalanceState& state = state_of(shared);
    double* numbers = reinterpret_cast<double*>(shared + kStateFloats);
    if (phase == 0) {
      const int first = is_last ? BalanceState::kMode : BalanceState::kTurn;
      gather(turn == 0 ? first : state.stage, state, block, thread, numbers + thread * kNumbers);
    } else if (phase <= kHalvings) {
      const int half = (kThreads >> phase) * kNumbers;
      for (int k = thread; k < half; k += kThreads) numbers[k] += numbers[half + k];
    } else if (phase == kHalvings + 1) {
      if (thread != 0) return;
      if (turn == 0) state.stage = is_last ? BalanceState::kMode : BalanceState::kTurn;
      if (turn == 0) state.round = 0;
      decide(state, block, numbers);
    } else {
      act(state, block, thread);
    }
  }

 private:
  PLIANT_HOST_DEVICE static BalanceState& state_of(float* shared) {
    return *reinterpret_cast<BalanceState*>(shared);
  }
  PLIANT_HOST_DEVICE static const BalanceState& state_of(const float* shared) {
    return *reinterpret_cast<const BalanceState*>(shared);
  }
  PLIANT_HOST_DEVICE int first_of(int block) const {
    return components.members[components.begins[block]];
  }
  PLIANT_HOST_DEVICE double quantum_of(int block) const {
    return arrays.rules[scene_of(arrays, first_of(block))].quantum;
  }
  PLIANT_HOST_DEVICE Eigen::Vector3d place_of(const Fixed& at, double quantum) const {
    return quantum * Eigen::Vector3d(at.x, at.y, at.z);
  }
  template <class Each>
  PLIANT_HOST_DEVICE void for_members(int block, int thread, const Each& each) const {
    const int end = components.begins[block + 1];
    for (int k = components.begins[block] + thread; k < end; k += kThreads) {
      each(components.members[k]);
    }
  }

  PLIANT_HOST_DEVICE void gather(int stage, const BalanceState& state, int block, int thread,
                                 double* to) const {
    for (int k = 0; k < kNumbers; ++k) to[k] = 0.0;
    const double quantum = quantum_of(block);
    if (stage == BalanceState::kTurn) {
      auto& sums = *reinterpret_cast<rigid::Moments*>(to);
      const Fixed origin = series.now[first_of(block)];
      for_members(block, thread, [&](int i) { add_moments(i, origin, quantum, sums); });
    } else if (stage == BalanceState::kMode) {
      auto& sums = *reinterpret_cast<ModeSums*>(to);
      const Fixed origin = x[first_of(block)];
      for_members(block, thread, [&](int i) { add_mode(i, origin, quantum, sums); });
    } else if (stage == BalanceState::kTrial) {
      auto& sums = *reinterpret_cast<BalanceSearch::Trial*>(to);
      for_members(block, thread, [&](int i) { add_trial(state, i, quantum, sums); });
    } else {
      auto& sums = *reinterpret_cast<TakenSums*>(to);
      for_members(block, thread, [&](int i) { add_taken(state, i, quantum, sums); });
    }
  }

  PLIANT_HOST_DEVICE void add_moments(int i, const Fixed& origin, double quantum,
                                      rigid::Moments& sums) const {
    const double m = series.now[i].w;
    const Eigen::Vector3d q = quantum * difference(series.now[i], origin),
                          y = quantum * difference(series.predicted[i], origin);
    sums.mass += m;
    sums.start += m * q;
    sums.predicted += m * y;
    sums.second += (m * q) * q.transpose();
    sums.mixed += (m * y) * q.transpose();
  }

  PLIANT_HOST_DEVICE void add_mode(int i, const Fixed& origin, double quantum,
                                   ModeSums& sums) const {
    const double m = series.now[i].w;
    const int number = scene_of(arrays, i);
    const Float3 added = added_way(series, series.rules[number], static_cast<float>(quantum), i);
    const Eigen::Vector3d q = quantum * difference(x[i], origin);
    // Where nothing but external forces act, it goes to the prediction before that was rounded.
    const Eigen::Vector3d way =
        difference(series.predicted[i], x[i]) + in_double(series.left[i].xyz());
    Eigen::Vector3d g = (m * quantum) * way;
    const Eigen::Vector3d external = (m * quantum) * in_double(added);
    rigid::Sums& own = sums.particles;
    own.size += (g - external).norm() + external.norm();
    if (arrays.anchors != nullptr && arrays.anchors[i].w > 0.0f) {
      const double e = arrays.anchors[i].w;
      const Eigen::Vector3d pull = (e * quantum) * difference(arrays.anchors[i], x[i]);
      g += pull;
      own.size += pull.norm();
      own.held += e;
      own.held_first += e * q;
      own.held_second += (e * q) * q.transpose();
    }
    own.mass += m;
    own.first += m * q;
    own.second += (m * q) * q.transpose();
    own.force += g;
    own.torque += q.cross(g);
    add_contacts(i, q, number, quantum, sums);
  }

  PLIANT_HOST_DEVICE void add_contacts(int i, const Eigen::Vector3d& q, int number, double quantum,
                                       ModeSums& sums) const {
    const BalanceContacts contacts = {series};
    if (contacts.count(i) == 0) return;
    const double rest = series.rules[number].contact.rest;
    for (int k = 0; k < series.slots; ++k) {
      if (!contacts.is_there(i, k)) continue;
      const BalanceRow row = contacts.row(i, k, x[i], quantum);
      const Eigen::Vector3d force = row.force();
      sums.force += force;
      sums.torque += q.cross(force);
      sums.size += force.norm();
      sums.contacts += 1.0;
      if (row.gap < -rest) sums.missed += 1.0;
    }
  }

  /// Calls `each` with the row, its compliance, its lever, its answer to `motion` and its slot.
  template <class Each>
  PLIANT_HOST_DEVICE void for_responses(const BalanceState& state, const rigid::Vector6& motion,
                                        int i, double quantum, const Each& each) const {
    const BalanceContacts contacts = {series};
    const int count = contacts.count(i);
    if (count == 0) return;
    const double compliance = static_cast<double>(count) * arrays.mobility[i];
    const Eigen::Vector3d lever = (place_of(x[i], quantum) - state.mode.center) / state.mode.radius;
    const Eigen::Vector3d shift(motion[0], motion[1], motion[2]),
        turn(motion[3], motion[4], motion[5]);
    const Eigen::Vector3d u = shift + turn.cross(lever);
    for (int k = 0; k < series.slots; ++k) {
      if (!contacts.is_there(i, k)) continue;
      const BalanceRow row = contacts.row(i, k, x[i], quantum);
      const int slot = series.slots * i + k;
      each(row, lever,
           state.is_coulomb ? ContactResponse(row, compliance, u)
                            : ContactResponse::with_bound(row, compliance, u, bounds[slot]),
           slot);
    }
  }

  PLIANT_HOST_DEVICE void add_trial(const BalanceState& state, int i, double quantum,
                                    BalanceSearch::Trial& sums) const {
    for_responses(
        state, state.motion, i, quantum,
        [&](const BalanceRow& row, const Eigen::Vector3d& lever, const ContactResponse& now, int) {
          const Eigen::Vector3d force = now.force(row);
          sums.force += force;
          sums.turning += lever.cross(force);
          if (!state.is_coulomb) sums.potential += now.potential(row);
          // u = t + φ × l = t − [l]φ
          const Eigen::Matrix3d k = now.stiffness(row, state.is_coulomb);
          const Eigen::Matrix3d cross = rigid::cross_matrix(lever);
          const Eigen::Matrix3d right = -(k * cross), below = cross * k, turns = cross * right;
          for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
              sums.stiffness[6 * a + b] += k(a, b);
              sums.stiffness[6 * a + 3 + b] += right(a, b);
              sums.stiffness[6 * (3 + a) + b] += below(a, b);
              sums.stiffness[6 * (3 + a) + 3 + b] += turns(a, b);
            }
          }
        });
  }

  /// Its force as the arrays hold it.
  PLIANT_HOST_DEVICE static DeviceContactForce stored(const ContactResponse& now) {
    return {static_cast<float>(now.normal_force), in_single(now.friction_force)};
  }
  PLIANT_HOST_DEVICE static Eigen::Vector3d force_of(const DeviceContactForce& force,
                                                     const BalanceRow& row) {
    return static_cast<double>(force.normal) * row.normal + in_double(force.friction);
  }

  PLIANT_HOST_DEVICE void add_taken(const BalanceState& state, int i, double quantum,
                                    TakenSums& sums) const {
    for_responses(
        state, state.motion, i, quantum,
        [&](const BalanceRow& row, const Eigen::Vector3d& lever, const ContactResponse& now, int) {
          const Eigen::Vector3d force = force_of(stored(now), row);
          sums.force += force;
          sums.turning += lever.cross(force);
          const double share = static_cast<double>(arrays.mobility[i]) * series.now[i].w;
          const Eigen::Vector3d held = share * (force - row.force());
          sums.way += held;
          sums.spin += lever.cross(held);
        });
  }

  PLIANT_HOST_DEVICE void decide(BalanceState& state, int block, const double* numbers) const {
    state.deed = BalanceState::kNothing;
    if (state.stage == BalanceState::kTurn) {
      state.turn = rigid::turn_of(*reinterpret_cast<const rigid::Moments*>(numbers));
      state.deed = state.turn.any ? BalanceState::kSpin : BalanceState::kNothing;
      state.stage = BalanceState::kMode;
    } else if (state.stage == BalanceState::kMode) {
      find_mode(state, block, *reinterpret_cast<const ModeSums*>(numbers));
    } else if (state.stage == BalanceState::kTrial) {
      search(state).look(*reinterpret_cast<const BalanceSearch::Trial*>(numbers));
    } else {
      take(state, *reinterpret_cast<const TakenSums*>(numbers));
    }
  }
  PLIANT_HOST_DEVICE BalanceSearch search(BalanceState& state) const {
    return {state, is_last ? BalanceSearch::kLastTolerance : BalanceSearch::kTolerance};
  }

  PLIANT_HOST_DEVICE void find_mode(BalanceState& state, int block, const ModeSums& sums) const {
    const double quantum = quantum_of(block);
    const Eigen::Vector3d origin = place_of(x[first_of(block)], quantum);
    state.mode = rigid::mode_of(sums.particles, origin, 1.0);
    state.mode.size += sums.size;
    state.has_contacts = sums.contacts > 0.0;
    state.is_coulomb = true;
    const Eigen::Vector3d middle = state.mode.center - origin;
    const Eigen::Vector3d torque = (sums.torque - middle.cross(sums.force)) / state.mode.radius;
    state.balance = state.mode.unbalanced;
    double worst = 0.0;
    for (int k = 0; k < 3; ++k) {
      state.balance[k] += sums.force[k];
      state.balance[3 + k] += torque[k];
    }
    for (int k = 0; k < 6; ++k) worst = greater(worst, std::fabs(state.balance[k]));
    // What moves it by less than half a quantum is round-off.
    const double least =
        rigid::kRoundOff * state.mode.size + 0.5 * quantum * state.mode.inertial_rate;
    const bool is_balanced = worst <= least && sums.missed == 0.0;
    if (is_last && (is_balanced || state.round == kRounds)) {
      state.stage = BalanceState::kDone;
      return;
    }
    ++state.round;
    if (state.has_contacts) return search(state).begin();
    move_to(state, state.mode.unbalanced, sums.particles.held > 0.0);
  }

  /// To the motion that so large forces demand.
  PLIANT_HOST_DEVICE void move_to(BalanceState& state, const rigid::Vector6& forces,
                                  bool is_held) const {
    rigid::Matrix6 matrix = state.mode.inertia;
    rigid::Vector6 right = forces;
    state.motion = is_held ? rigid::solve(matrix, right) : state.mode.holding(forces);
    state.deed = BalanceState::kMove;
    state.stage = is_last ? BalanceState::kMode : BalanceState::kDone;
  }

  PLIANT_HOST_DEVICE void take(BalanceState& state, const TakenSums& sums) const {
    rigid::Vector6 forces = state.mode.unbalanced, local;
    for (int k = 0; k < 3; ++k) {
      forces[k] += sums.force[k];
      forces[3 + k] += sums.turning[k];
      local[k] = sums.way[k];
      local[3 + k] = sums.spin[k];
    }
    state.contact_motion = state.motion;
    // Whatever the search left, the impulses of these forces are what the motion holds. Contacts
    // give way by what their forces changed: that holds a momentum that no force gave it.
    move_to(state, forces, true);
    const rigid::Vector6 back = state.mode.holding(local);
    for (int k = 0; k < 6; ++k) state.motion[k] -= back[k];
  }

  PLIANT_HOST_DEVICE void act(const BalanceState& state, int block, int thread) const {
    if (state.deed == BalanceState::kNothing) return;
    const double quantum = quantum_of(block);
    if (state.deed == BalanceState::kSpin) {
      const Fixed origin = series.now[first_of(block)];
      for_members(block, thread, [&](int i) {
        const Eigen::Vector3d q = quantum * difference(series.now[i], origin),
                              y = quantum * difference(series.predicted[i], origin);
        x[i] = moved_far(x[i], state.turn.way(q, y) / quantum);
      });
    } else if (state.deed == BalanceState::kMove) {
      const Eigen::Vector3d turn(state.motion[3], state.motion[4], state.motion[5]);
      const Eigen::Matrix3d change = rigid::change_of(turn / state.mode.radius);
      for_members(block, thread, [&](int i) { move(state, change, quantum, i); });
    } else {
      for_members(block, thread, [&](int i) { set_bounds(state, quantum, i); });
    }
  }

  PLIANT_HOST_DEVICE void move(const BalanceState& state, const Eigen::Matrix3d& change,
                               double quantum, int i) const {
    const Eigen::Vector3d shift(state.motion[0], state.motion[1], state.motion[2]);
    Eigen::Vector3d way = shift + change * (place_of(x[i], quantum) - state.mode.center);
    if (state.has_contacts) {
      for_responses(
          state, state.contact_motion, i, quantum,
          [&](const BalanceRow& row, const Eigen::Vector3d&, const ContactResponse& now, int slot) {
            const DeviceContactForce force = stored(now);
            way += static_cast<double>(arrays.mobility[i]) * (force_of(force, row) - row.force());
            // Iterations find the forces anew.
            if (is_last) series.forces[slot] = force;
          });
    }
    x[i] = moved_far(x[i], way / quantum);
  }

  PLIANT_HOST_DEVICE void set_bounds(const BalanceState& state, double quantum, int i) const {
    for_responses(
        state, state.motion, i, quantum,
        [&](const BalanceRow& row, const Eigen::Vector3d&, const ContactResponse& now, int slot) {
          bounds[slot] = row.friction_bound(
              state.deed == BalanceState::kBoundsOfRows ? row.normal_force : now.normal_force);
        });
  }
};

/// Where the iterations ended, with what they moved into obstacles: ContactEffect::look_again().
struct LookAgainStep {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = scene_of(arrays, i);
    const SceneState scene = arrays.scene(number);
    if (!scene.rules.is_due || !series.is_balanced(i)) return;
    const Fixed x = arrays.ended(scene.control, i);
    series.ended[i] = x;
    const SeriesRules& rules = series.rules[number];
    const float quantum = scene.rules.quantum;
    const Float3 from = place(series.now[i], quantum), to = place(x, quantum);
    for (int k = 0; k < rules.obstacles; ++k) {
      const FoundContact late =
          find_contact(series.obstacles[rules.first_obstacle + k], rules.contact, from, to);
      if (!late.is_there || late.gap >= 0.0f) continue;
      DeviceContact& contact = series.contacts[series.slots * i + k];
      DeviceContactForce& force = series.forces[series.slots * i + k];
      // The gap is kept as it would be at the prediction.
      const float since = quantum * dot(late.normal, x - series.predicted[i]);
      contact.plane = with_w(late.normal, late.gap - since);
      force.friction -= dot(late.normal, force.friction) * late.normal;
      series.first[i] = i;
    }
  }
};

/// Then each contact's particle comes to its plane: ContactEffect::finish().
struct FinishContacts {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const SceneState scene = arrays.scene(scene_of(arrays, i));
    if (!scene.rules.is_due || !series.is_balanced(i)) return;
    const BalanceContacts contacts = {series};
    if (contacts.count(i) == 0) return;
    const double quantum = scene.rules.quantum, own = arrays.mobility[i];
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    for (int k = 0; k < series.slots; ++k) {
      if (!contacts.is_there(i, k)) continue;
      const BalanceRow row = contacts.row(i, k, series.ended[i], quantum);
      const double gap = row.gap + row.normal.dot(way);
      const double delta = greater(-gap / own, -row.normal_force);
      way += (own * delta) * row.normal;
      // No iteration answers this move any more: what it changes is momentum alone, m Δx/h².
      series.forces[series.slots * i + k].normal =
          static_cast<float>(row.normal_force + own * series.now[i].w * delta);
    }
    series.ended[i] = moved_far(series.ended[i], way / quantum);
  }
};

}  // namespace pliant
