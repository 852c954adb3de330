#pragma once

#include "cuda/effects/device_contact.h"
#include "cuda/solvers/resident_run/balance_motion.h"
#include "cuda/solvers/step_state.h"

/// What surrounds the iterations of a step whose state stays on the device: prediction, contacts,
/// velocities, as ProjectiveSolver and the contact effect do them on the host.
namespace pliant {

/// What each step of one scene does.
struct ResidentRules {
  Float3 fall = {0.0f, 0.0f, 0.0f};  ///< displacement in a step by the acceleration [quanta]
  float velocity_loss = 0.0f;        ///< share of velocities that each step ends without
  float most_displacement = 0.0f;    ///< longest of a step, squared [quanta²]
  int first_obstacle = 0, obstacles = 0;
  ContactRules contact = {};
};

/// What came of all steps of a scene.
struct ResidentTally {
  int touches;     ///< in the running step something is near an obstacle
  int presses;     ///< in the running step some contact carries force, for those who ask
  int failed;      ///< left all bounds
  float fastest;   ///< largest velocity after the last step, squared, for those who ask [quanta²]
  int lost;        ///< some step lost momentum: forces told more of it than there was
  int unbalanced;  ///< some step found no contact forces that balance a free component
  int damped, lowered;
  double radius;  ///< lowest, where some step lowered it
};

/// State of the particles between steps, in the order of the packed system.
struct ResidentArrays {
  Fixed* now = nullptr;           ///< position, and M/h² [N/m]
  Fixed* was = nullptr;           ///< and when the last step began
  Float4* velocity = nullptr;     ///< times the time step [quanta]
  Float4* before = nullptr;       ///< and when the step before began
  Float4* left = nullptr;         ///< what rounding took from the prediction [quanta]
  const Float4* pulls = nullptr;  ///< forces besides those of elements [N]; null: none
  Fixed* predicted = nullptr;
  Fixed* start = nullptr;
  // Contact k of particle i, with obstacle k of its scene, stands at slots i + k.
  int slots = 0;
  DeviceContact* contacts = nullptr;
  DeviceContactForce* forces = nullptr;
  int* first = nullptr;
  const ResidentRules* rules = nullptr;  ///< one a scene
  ResidentTally* tally = nullptr;        ///< likewise
  StepRules* step_rules = nullptr;       ///< likewise
  const DeviceObstacle* obstacles = nullptr;
  // Of particles whose component nothing holds from outside (balance_components.h).
  const int* component = nullptr;         ///< of each place, -1: none; null: there are none
  const Fixed* ended = nullptr;           ///< where they are after the iterations
  const BalanceMotion* missed = nullptr;  ///< motions of components that velocities lack

  PLIANT_HOST_DEVICE int component_of(int i) const {
    return component == nullptr ? -1 : component[i];
  }
};

PLIANT_HOST_DEVICE inline int scene_of(const StepArrays& arrays, int i) {
  return arrays.scene_of_block == nullptr ? 0 : arrays.scene_of_block[i / arrays.block];
}
/// What acceleration adds to a particle's displacement in a step [quanta].
PLIANT_HOST_DEVICE inline Float3 added_displacement(const ResidentArrays& resident,
                                                    const ResidentRules& rules, float quantum,
                                                    int i) {
  if (resident.pulls == nullptr) return rules.fall;
  // h² f/m = f / (M/h²).
  return rules.fall + (1.0f / (resident.now[i].w * quantum)) * resident.pulls[i].xyz();
}
PLIANT_HOST_DEVICE inline Float3 place(const Fixed& x, float quantum) {
  return {quantum * static_cast<float>(x.x), quantum * static_cast<float>(x.y),
          quantum * static_cast<float>(x.z)};
}

/// Prediction and contacts of a step.
struct PredictStep {
  StepArrays arrays;
  ResidentArrays resident;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = scene_of(arrays, i);
    const ResidentRules& rules = resident.rules[number];
    const Fixed now = resident.now[i];
    if (resident.slots > 0) resident.first[i] = -1;
    if (arrays.mobility[i] == 0.0f) {
      resident.predicted[i] = now;
      return;
    }
    const float quantum = arrays.scene(number).rules.quantum;
    const Float3 whole =
        resident.velocity[i].xyz() + added_displacement(resident, rules, quantum, i);
    const Fixed predicted = moved(now, whole);
    resident.left[i] = with_w(whole - (predicted - now), 0.0f);
    resident.predicted[i] = predicted;
    find(i, now, predicted, rules, quantum);
  }

 private:
  PLIANT_HOST_DEVICE void find(int i, const Fixed& now, const Fixed& predicted,
                               const ResidentRules& rules, float quantum) const {
    constexpr float kFar = 1e30f;
    const Float3 from = place(now, quantum), to = place(predicted, quantum);
    bool any = false;
    for (int k = 0; k < resident.slots; ++k) {
      FoundContact found = {false, {0.0f, 0.0f, 0.0f}, kFar};
      float friction = 0.0f;
      if (k < rules.obstacles) {
        const DeviceObstacle& obstacle = resident.obstacles[rules.first_obstacle + k];
        found = find_contact(obstacle, rules.contact, from, to);
        friction = obstacle.friction;
      }
      any = any || found.is_there;
      DeviceContact& contact = resident.contacts[resident.slots * i + k];
      contact.particles = {{i, -1, -1, -1}};
      contact.weights = {1.0f, 0.0f, 0.0f, 0.0f};
      contact.plane = with_w(found.normal, found.is_there ? found.gap : kFar);
      contact.slip = with_w(quantum * (predicted - now), friction);
      resident.forces[resident.slots * i + k] = {0.0f, {0.0f, 0.0f, 0.0f}};
    }
    if (!any) return;
    resident.first[i] = i;
    // All threads write the same number, and nobody reads it before they are done.
    resident.tally[scene_of(arrays, i)].touches = 1;
  }
};

/// The first iterate: as start_near_solution(), the acceleration of the last step goes on.
struct StartStep {
  StepArrays arrays;
  ResidentArrays resident;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    constexpr float kRoundOff = 1e-4f;
    const int number = scene_of(arrays, i);
    const Fixed predicted = resident.predicted[i];
    resident.start[i] = predicted;
    if (resident.tally[number].touches == 0 || arrays.mobility[i] == 0.0f) return;
    const Float3 fall =
        added_displacement(resident, resident.rules[number], arrays.scene(number).rules.quantum, i);
    const float squared = dot(fall, fall);
    if (squared == 0.0f) return;
    const float along = dot(resident.velocity[i].xyz() - resident.before[i].xyz(), fall) / squared;
    if (along > 1.0f - kRoundOff) return;
    resident.start[i] = moved(predicted, (along > 0.0f ? along - 1.0f : -1.0f) * fall);
  }
};

/// Pushes out what the iterations moved into obstacles, then velocities.
struct EndStep {
  StepArrays arrays;
  ResidentArrays resident;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = scene_of(arrays, i);
    const SceneState scene = arrays.scene(number);
    ResidentTally& tally = resident.tally[number];
    if (!scene.rules.is_due || arrays.mobility[i] == 0.0f) return;
    const Fixed now = resident.now[i];
    const int component = resident.component_of(i);
    Fixed x = component < 0 ? arrays.ended(scene.control, i) : resident.ended[i];
    push_out(i, now, resident.rules[number], scene.rules.quantum, x);
    Float3 displacement = (x - now) + resident.left[i].xyz();
    if (component >= 0) displacement += lacking(i, component, scene.rules.quantum);
    // A GPU rounds what is not a number to 0: positions alone would not show it.
    const bool is_slow =
        dot(displacement, displacement) <= resident.rules[number].most_displacement;
    if (scene.control.result == StepControl::kNotFinite || !is_near(x) || !is_slow) {
      tally.failed = 1;
      return;
    }
    resident.was[i] = now;
    resident.before[i] = resident.velocity[i];
    resident.velocity[i] =
        with_w(displacement - resident.rules[number].velocity_loss * displacement, 0.0f);
    x.w = now.w;
    resident.now[i] = x;
  }

 private:
  /// What the velocity lacks of the momentum that forces give, times the time step [quanta].
  PLIANT_HOST_DEVICE Float3 lacking(int i, int component, double quantum) const {
    const BalanceMotion& motion = resident.missed[component];
    return in_single((1.0 / quantum) * motion.of(motion.arm(resident.ended[i], quantum)));
  }
  /// Iterates of the next step have room left.
  PLIANT_HOST_DEVICE static bool is_near(const Fixed& x) {
    constexpr int kMost = 1 << 29;
    return x.x > -kMost && x.x < kMost && x.y > -kMost && x.y < kMost && x.z > -kMost &&
           x.z < kMost;
  }

  PLIANT_HOST_DEVICE void push_out(int i, const Fixed& now, const ResidentRules& rules,
                                   float quantum, Fixed& x) const {
    const Float3 from = place(now, quantum);
    for (int k = 0; k < rules.obstacles; ++k) {
      const FoundContact late = find_contact(resident.obstacles[rules.first_obstacle + k],
                                             rules.contact, from, place(x, quantum));
      if (!late.is_there || late.gap >= 0.0f) continue;
      x = moved(x, (-late.gap / quantum) * late.normal);
      // No iteration answers this move any more: what it changes is momentum alone, m Δx/h².
      DeviceContact& contact = resident.contacts[resident.slots * i + k];
      contact.plane = with_w(late.normal, contact.plane.w);
      resident.forces[resident.slots * i + k].normal += -late.gap * now.w;
      resident.first[i] = i;
    }
  }
};

/// What a step leaves for the report, of each scene.
struct TallyStep {
  StepArrays arrays;
  ResidentArrays resident;

  PLIANT_HOST_DEVICE void operator()(int number) const {
    const StepControl& control = arrays.control[number];
    ResidentTally& tally = resident.tally[number];
    tally.touches = tally.presses = 0;
    tally.damped |= control.damped;
    if (control.stays_damped()) resident.step_rules[number].is_damped = true;
    if (!control.lowered) return;
    tally.radius = tally.lowered && tally.radius < control.radius ? tally.radius : control.radius;
    tally.lowered = 1;
  }
};

struct ClearTally {
  ResidentTally* tally;
  PLIANT_HOST_DEVICE void operator()(int number) const { tally[number] = {}; }
};

template <class T>
struct CopyNumbers {
  const T* from;
  T* to;
  PLIANT_HOST_DEVICE void operator()(int i) const { to[i] = from[i]; }
};

}  // namespace pliant
