#pragma once

#include "cuda/effects/device_contact.h"
#include "cuda/solvers/step_state.h"

/// What surrounds the iterations of a step whose state stays on the device: prediction, contacts,
/// velocities, as ProjectiveSolver and the contact effect do them on the host.
namespace pliant {

/// What each step of one scene does.
struct SeriesRules {
  Float3 fall = {0.0f, 0.0f, 0.0f};  ///< what the acceleration adds to a step's way [quanta]
  float velocity_loss = 0.0f;        ///< share of velocities that each step ends without
  int first_obstacle = 0, obstacles = 0;
  ContactRules contact = {};
};

/// What came of all steps of a scene.
struct SeriesTally {
  int touches;  ///< in the running step something is near an obstacle
  int failed;   ///< left all bounds
  int careful, lowered;
  double radius;  ///< lowest, where some step lowered it
};

/// State of the particles between steps, in the order of the packed system.
struct SeriesArrays {
  Fixed* now = nullptr;      ///< position, and M/h² [N/m]
  Fixed* was = nullptr;      ///< and when the last step began
  Float4* way = nullptr;     ///< velocity times the time step [quanta]
  Float4* before = nullptr;  ///< and when the step before began
  Float4* left = nullptr;    ///< what rounding took from the prediction [quanta]
  Fixed* predicted = nullptr;
  Fixed* start = nullptr;
  // Contact k of particle i, with obstacle k of its scene, stands at slots i + k.
  int slots = 0;
  DeviceContact* contacts = nullptr;
  DeviceContactForce* forces = nullptr;
  int* first = nullptr;
  const SeriesRules* rules = nullptr;  ///< one a scene
  SeriesTally* tally = nullptr;        ///< likewise
  StepRules* step_rules = nullptr;     ///< likewise
  const DeviceObstacle* obstacles = nullptr;
};

PLIANT_HOST_DEVICE inline int scene_of(const StepArrays& arrays, int i) {
  return arrays.scene_of_block == nullptr ? 0 : arrays.scene_of_block[i / arrays.block];
}
PLIANT_HOST_DEVICE inline Float3 place(const Fixed& x, float quantum) {
  return {quantum * static_cast<float>(x.x), quantum * static_cast<float>(x.y),
          quantum * static_cast<float>(x.z)};
}

/// Prediction and contacts of a step.
struct PredictStep {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = scene_of(arrays, i);
    const SeriesRules& rules = series.rules[number];
    const Fixed now = series.now[i];
    if (series.slots > 0) series.first[i] = -1;
    if (arrays.mobility[i] == 0.0f) {
      series.predicted[i] = now;
      return;
    }
    const Float3 way = series.way[i].xyz();
    const Float3 whole = way + rules.fall;
    const Fixed predicted = moved(now, whole);
    series.left[i] = with_w(whole - (predicted - now), 0.0f);
    series.predicted[i] = predicted;
    find(i, now, predicted, rules, arrays.scene(number).rules.quantum);
  }

 private:
  PLIANT_HOST_DEVICE void find(int i, const Fixed& now, const Fixed& predicted,
                               const SeriesRules& rules, float quantum) const {
    constexpr float kFar = 1e30f;
    const Float3 from = place(now, quantum), to = place(predicted, quantum);
    bool any = false;
    for (int k = 0; k < series.slots; ++k) {
      FoundContact found = {false, {0.0f, 0.0f, 0.0f}, kFar};
      float friction = 0.0f;
      if (k < rules.obstacles) {
        const DeviceObstacle& obstacle = series.obstacles[rules.first_obstacle + k];
        found = find_contact(obstacle, rules.contact, from, to);
        friction = obstacle.friction;
      }
      any = any || found.is_there;
      DeviceContact& contact = series.contacts[series.slots * i + k];
      contact.particles = {{i, -1, -1, -1}};
      contact.weights = {1.0f, 0.0f, 0.0f, 0.0f};
      contact.plane = with_w(found.normal, found.is_there ? found.gap : kFar);
      contact.slip = with_w(quantum * (predicted - now), friction);
      series.forces[series.slots * i + k] = {0.0f, {0.0f, 0.0f, 0.0f}};
    }
    if (!any) return;
    series.first[i] = i;
    // All threads write the same number, and nobody reads it before they are done.
    series.tally[scene_of(arrays, i)].touches = 1;
  }
};

/// The first iterate: as start_near_solution(), the acceleration of the last step goes on.
struct StartStep {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    constexpr float kRoundOff = 1e-4f;
    const int number = scene_of(arrays, i);
    const Fixed predicted = series.predicted[i];
    series.start[i] = predicted;
    const Float3 fall = series.rules[number].fall;
    const float squared = dot(fall, fall);
    if (series.tally[number].touches == 0 || squared == 0.0f || arrays.mobility[i] == 0.0f) return;
    const float along = dot(series.way[i].xyz() - series.before[i].xyz(), fall) / squared;
    if (along > 1.0f - kRoundOff) return;
    series.start[i] = moved(predicted, (along > 0.0f ? along - 1.0f : -1.0f) * fall);
  }
};

/// Pushes out what the iterations moved into obstacles, then velocities.
struct EndStep {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const int number = scene_of(arrays, i);
    const SceneState scene = arrays.scene(number);
    SeriesTally& tally = series.tally[number];
    if (!scene.rules.is_due || arrays.mobility[i] == 0.0f) return;
    const Fixed now = series.now[i];
    Fixed x = arrays.ended(scene.control, i);
    push_out(i, now, series.rules[number], scene.rules.quantum, x);
    const Float3 way = (x - now) + series.left[i].xyz();
    if (scene.control.result == StepControl::kNotFinite || !is_near(x) || !is_finite(way)) {
      tally.failed = 1;
      return;
    }
    series.was[i] = now;
    series.before[i] = series.way[i];
    series.way[i] = with_w(way - series.rules[number].velocity_loss * way, 0.0f);
    x.w = now.w;
    series.now[i] = x;
  }

 private:
  /// Iterates of the next step have room left.
  PLIANT_HOST_DEVICE static bool is_near(const Fixed& x) {
    constexpr int kMost = 1 << 29;
    return x.x > -kMost && x.x < kMost && x.y > -kMost && x.y < kMost && x.z > -kMost &&
           x.z < kMost;
  }

  /// A GPU rounds what is not a number to 0: positions alone would not show it.
  PLIANT_HOST_DEVICE static bool is_finite(Float3 way) {
    constexpr float kMost = 1e19f;  // squared, beyond what positions in range allow
    return dot(way, way) < kMost;
  }

  PLIANT_HOST_DEVICE void push_out(int i, const Fixed& now, const SeriesRules& rules, float quantum,
                                   Fixed& x) const {
    const Float3 from = place(now, quantum);
    for (int k = 0; k < rules.obstacles; ++k) {
      const FoundContact late = find_contact(series.obstacles[rules.first_obstacle + k],
                                             rules.contact, from, place(x, quantum));
      if (!late.is_there || late.gap >= 0.0f) continue;
      x = moved(x, (-late.gap / quantum) * late.normal);
      // No iteration answers this move any more: what it changes is momentum alone, m Δx/h².
      DeviceContact& contact = series.contacts[series.slots * i + k];
      contact.plane = with_w(late.normal, contact.plane.w);
      series.forces[series.slots * i + k].normal += -late.gap * now.w;
      series.first[i] = i;
    }
  }
};

/// What a step leaves for the report, of each scene.
struct TallyStep {
  StepArrays arrays;
  SeriesArrays series;

  PLIANT_HOST_DEVICE void operator()(int number) const {
    const StepControl& control = arrays.control[number];
    SeriesTally& tally = series.tally[number];
    tally.touches = 0;
    tally.careful |= control.careful;
    if (control.stays_careful()) series.step_rules[number].is_careful = true;
    if (!control.lowered) return;
    tally.radius = tally.lowered && tally.radius < control.radius ? tally.radius : control.radius;
    tally.lowered = 1;
  }
};

/// Force and torque of a block's particles on each obstacle, about its origin: 6 numbers a slot.
struct SumReactions {
  static constexpr int kPhases = 2;
  static constexpr int kNumbers = 6;
  StepArrays arrays;
  SeriesArrays series;
  float* sums;

  PLIANT_HOST_DEVICE void operator()(int phase, int block, int thread, float* shared) const {
    const int count = kNumbers * series.slots;
    if (phase == 0) {
      const int i = block * arrays.block + thread;
      for (int k = 0; k < count; ++k) shared[thread * count + k] = 0.0f;
      if (i < arrays.particles && series.first[i] >= 0) add(i, shared + thread * count);
      return;
    }
    for (int k = thread; k < count; k += arrays.block) {
      float sum = 0.0f;
      for (int t = 0; t < arrays.block; ++t) sum += shared[t * count + k];
      sums[block * count + k] = sum;
    }
  }

 private:
  PLIANT_HOST_DEVICE void add(int i, float* to) const {
    const int number = scene_of(arrays, i);
    const Float3 at = place(series.now[i], arrays.rules[number].quantum);
    for (int k = 0; k < series.rules[number].obstacles; ++k) {
      const DeviceContactForce& f = series.forces[series.slots * i + k];
      const Float3 normal = series.contacts[series.slots * i + k].plane.xyz();
      const Float3 force = -1.0f * (f.normal * normal + f.friction);
      const Float3 arm = at - series.obstacles[series.rules[number].first_obstacle + k].position;
      const Float3 torque = cross(arm, force);
      const float values[kNumbers] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
      for (int m = 0; m < kNumbers; ++m) to[kNumbers * k + m] = values[m];
    }
  }
};

}  // namespace pliant
