#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "cuda/geometry/device_grids.h"
#include "cuda/solvers/blocks/vertex_blocks.h"
#include "cuda/solvers/device_step.h"
#include "cuda/solvers/resident_run/device_resident_run.h"
#include "cuda/solvers/scenes/joined_system.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// What a solver leaves for the device before a step, and finds after it.
struct DeviceScene {
  bool is_there = true;  ///< false: its solver is gone
  bool is_due = false;   ///< it takes the next step
  // Of the system; whoever changes these calls DeviceScenes::changed().
  PackedSystem packed;
  std::vector<float> mobility;  ///< γ/D of each place [m/N]
  // Of the step.
  std::vector<Fixed> predicted, start;
  std::vector<Fixed> anchors;  ///< empty: none
  std::vector<float> spins;    ///< pack_spins()
  ContactTable contacts;       ///< of places in its own system
  StepRules rules;
  bool is_estimated = false;  ///< else the next step finds the spectral radius
  double estimate = 0.0;
  // After it.
  std::vector<Float4> displacement;
  StepControl control;
  // Of a resident run (resident_run.h): before and after it.
  int resident_steps = 0;     ///< 0: the next step is one of its own
  int resident_substeps = 1;  ///< of each step, where the scene is alone
  int resident_follow = 0;    ///< steps after these that may begin before anybody asks for them
  int taken = 0;              ///< steps of the last resident run
  Readback readback = Readback::kState;     ///< at its end, where the scene is alone
  const EmbeddedPoints* surface = nullptr;  ///< null: the particles
  Readback available = Readback::kState;    ///< what was read back of the state
  ResidentExtent extent = {};               ///< where no motion was read back
  ResidentRules resident_rules;
  /// Places of connected components that nothing holds from outside, and where each begins, with
  /// the end.
  std::vector<int> component_members, component_begins;
  std::vector<DeviceObstacle> obstacles;
  std::vector<std::shared_ptr<const Shape>> shapes;  ///< of these
  std::vector<Fixed> now, was;
  std::vector<Float4> velocity, velocity_before;  ///< as ResidentArrays has them
  ResidentTally tally = {};
  std::vector<double> reactions;  ///< kReactionNumbers an obstacle
};

/// What all scenes of one launch have in common.
struct DeviceScenesKey {
  int iterations = 0;
  int delay = 0;              ///< plain iterations before acceleration
  int block = 0, passes = 0;  ///< BlockPlan
  DeviceIteration::Kind kind = DeviceIteration::kJacobi;
  int history = 0, sweeps = 0;  ///< DeviceIteration
  bool is_multigrid = false;    ///< likewise

  bool operator<(const DeviceScenesKey& o) const {
    return std::tie(iterations, delay, block, passes, kind, history, sweeps, is_multigrid) <
           std::tie(o.iterations, o.delay, o.block, o.passes, o.kind, o.history, o.sweeps,
                    o.is_multigrid);
  }
  bool operator==(const DeviceScenesKey& o) const { return !(*this < o) && !(o < *this); }
};

/// Scenes whose steps an executor computes at once. Solvers fill their scenes in any threads; one
/// thread runs them. A scene depends on no other, to the last bit; but when one of them changed,
/// the search for rotations of the others' tetrahedra begins anew, as after a change of their own.
template <class Executor>
class DeviceScenes {
 public:
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  explicit DeviceScenes(const DeviceScenesKey& key) : key_(key) {}
  const DeviceScenesKey& key() const { return key_; }

  DeviceScene& add() {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_changed_ = true;
    return scenes_.emplace_back();
  }
  void changed() {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_changed_ = true;
  }
  /// Of DeviceScene::mobility alone.
  void mobility_changed() {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_new_mobility_ = true;
  }
  /// One step of each that is due, or a resident run of equally many of all of these.
  /// Throws DeviceFailure.
  void run() {
    const int steps = resident_steps();
    if (steps > 0) return run_resident(steps);
    upload();
    iterate();
    download();
  }
  /// Steps of the next resident run that are under way already; 0: none. They begin where the last
  /// one ended.
  int following() const { return following_; }
  /// Nobody will ask for them.
  void forget_following() { following_ = 0; }
  /// Where the vertices of the only scene's surface are, where that was read back [quanta].
  const Staged<Quanta3>& seen_surface() const { return surface_; }
  /// Reads back the rest of its state at the end of the last resident run.
  void read_back_state();
  /// What acts on the only scene in the next resident run besides; null: nothing.
  void set_forces(std::shared_ptr<ResidentForces<Executor>> forces) { forces_ = std::move(forces); }
  /// The last resident run, for those who time it; null where there was none.
  DeviceResidentRun<Executor>* resident_run() { return resident_run_.get(); }
  // What a step is made of.
  void upload();
  void iterate();
  void download();

 private:
  static constexpr int kCopyGrain = 16384;

  /// A scene's own of what was downloaded.
  template <class T>
  void take_back(const Staged<T>& joined, std::size_t s, std::vector<T>& own) const {
    own.resize(bound_[s]->packed.order.size());
    copy_all(joined.begin() + first_places_[s], static_cast<int>(own.size()), own.begin());
  }
  template <class From, class To>
  static void copy_all(From from, int count, To to) {
    parallel_for(0, count, kCopyGrain,
                 [&](int begin, int end) { std::copy(from + begin, from + end, to + begin); });
  }
  void bind_if_changed();
  void bind();
  int resident_steps() const;
  int resident_substeps() const;
  void run_resident(int steps);
  void bind_resident_run();
  void upload_resident_run();
  void upload_components();
  void download_resident_run(int taken);
  bool may_follow() const;
  void launch_following();
  Readback actual_readback() const;
  void begin_readback(Readback readback);
  void take_readback(Readback readback);
  void upload_anchors();
  void upload_spins();
  void upload_contacts();
  void upload_rules();
  /// Of those alone whose spectral radius is not known; the others rest. Iterations stop at
  /// `tolerance`.
  void upload_rules_of_unknown(double tolerance);
  StepRules rules_of(DeviceScene& scene) const;
  bool is_unknown(const DeviceScene& scene) const { return scene.is_due && !scene.is_estimated; }
  bool is_any_unknown() const {
    return std::any_of(bound_.begin(), bound_.end(),
                       [&](const DeviceScene* scene) { return is_unknown(*scene); });
  }
  /// The radius of a Jacobi iteration, as ChebyshevSolver finds it. Returns whether anything
  /// iterated.
  bool estimate();
  /// From the changes of successive plain iterations; of scenes in free fall they say nothing.
  std::vector<bool> estimate_by_plain_iterations();
  /// From what accelerated iterations had to raise.
  void estimate_radius();
  /// Uses the values of all scenes, each at its places.
  template <class T, class Use>
  void at_places(std::vector<T> DeviceScene::*values, Staged<T>& joined, const Use& use) const;
  template <class Use>
  void for_each_scene(const Use& use) const {
    parallel_for(0, static_cast<int>(bound_.size()), 16, [&](int begin, int end) {
      for (int s = begin; s < end; ++s) use(static_cast<std::size_t>(s));
    });
  }

  DeviceScenesKey key_;
  std::mutex mutex_;
  std::deque<DeviceScene> scenes_;  // a deque, since solvers refer to theirs
  bool has_changed_ = false, has_new_mobility_ = false;
  std::unique_ptr<DeviceStep<Executor>> step_;
  std::unique_ptr<DeviceResidentRun<Executor>> resident_run_;  // null: there was none yet
  std::shared_ptr<ResidentForces<Executor>> forces_;
  int following_ = 0;
  DeviceGrids<Executor> grids_;
  std::vector<DeviceScene*> bound_;
  std::vector<int> first_places_;  // of each bound scene, and the end
  bool has_anchors_ = false;
  Staged<Fixed> predicted_, start_, now_, was_;
  Staged<Float4> velocity_, velocity_before_;
  Staged<Quanta3> surface_;
  Staged<ResidentExtent> extents_;
  Staged<float> mobility_;
  Staged<Float4> displacement_;
  ContactTable contacts_;
};

template <class Executor>
void DeviceScenes<Executor>::bind_if_changed() {
  if (has_changed_) {
    bind();
  } else if (has_new_mobility_) {
    at_places(&DeviceScene::mobility, mobility_,
              [&](const auto& values) { step_->set_mobility(values); });
  }
  has_changed_ = has_new_mobility_ = false;
}

template <class Executor>
void DeviceScenes<Executor>::bind() {
  bound_.clear();
  std::vector<const PackedSystem*> systems;
  for (DeviceScene& scene : scenes_) {
    if (!scene.is_there) continue;
    bound_.push_back(&scene);
    systems.push_back(&scene.packed);
  }
  resident_run_.reset();
  step_.reset();  // its memory may be needed
  if (bound_.empty()) return;
  const PackedSystem joined = bound_.size() > 1 ? join(systems) : PackedSystem();
  const PackedSystem& packed = bound_.size() > 1 ? joined : *systems.front();
  first_places_.clear();
  for (int block : packed.scene_begins) first_places_.push_back(block * packed.block);
  // Small bodies have too few blocks to fill a GPU: several threads then share a particle's
  // elements. Large ones do best with few threads, since blocks wait for their slowest.
  step_ = std::make_unique<DeviceStep<Executor>>(packed, packed.particles >= kLargeBody ? 1 : 4);
  for (Staged<Fixed>* staged : {&predicted_, &start_, &now_}) staged->clear();
  for (Staged<Float4>* staged : {&velocity_, &velocity_before_}) staged->clear();
  mobility_.clear();
  at_places(&DeviceScene::mobility, mobility_,
            [&](const auto& values) { step_->set_mobility(values); });
  has_anchors_ = false;
}

template <class Executor>
template <class T, class Use>
void DeviceScenes<Executor>::at_places(std::vector<T> DeviceScene::*values, Staged<T>& joined,
                                       const Use& use) const {
  // What no scene fills, at the ends of their last blocks, stays zero.
  joined.resize(static_cast<std::size_t>(step_->particles()), T{});
  for_each_scene([&](std::size_t s) {
    const std::vector<T>& own = bound_[s]->*values;
    copy_all(own.begin(), static_cast<int>(own.size()), joined.begin() + first_places_[s]);
  });
  use(joined);
}

template <class Executor>
void DeviceScenes<Executor>::upload() {
  bind_if_changed();
  if (bound_.empty()) return;
  at_places(&DeviceScene::predicted, predicted_,
            [&](const auto& values) { step_->set_predicted(values); });
  at_places(&DeviceScene::start, start_, [&](const auto& values) { step_->set_start(values); });
  upload_anchors();
  upload_spins();
  upload_contacts();
  upload_rules();
}

template <class Executor>
void DeviceScenes<Executor>::upload_anchors() {
  const bool any = std::any_of(bound_.begin(), bound_.end(),
                               [](const DeviceScene* scene) { return !scene->anchors.empty(); });
  if (any) {
    Staged<Fixed> anchors;  // a scene may have none now that had some before
    at_places(&DeviceScene::anchors, anchors,
              [&](const auto& values) { step_->set_anchors(values); });
    step_->executor().synchronize();
  } else if (has_anchors_) {
    step_->set_anchors(std::vector<Fixed>());
  }
  has_anchors_ = any;
}

template <class Executor>
void DeviceScenes<Executor>::upload_spins() {
  const bool any = std::any_of(bound_.begin(), bound_.end(),
                               [](const DeviceScene* scene) { return !scene->spins.empty(); });
  if (!any) return;
  std::vector<float> spins;
  for (const DeviceScene* scene : bound_) {
    const std::size_t count =
        ClustersView::kSpin * static_cast<std::size_t>(scene->packed.clusters.size());
    const std::size_t first = spins.size();
    spins.insert(spins.end(), scene->spins.begin(), scene->spins.end());
    spins.resize(first + count, 0.0f);
  }
  step_->set_spins(spins);
}

template <class Executor>
void DeviceScenes<Executor>::upload_contacts() {
  if (bound_.size() == 1) {
    step_->set_contacts(bound_.front()->contacts);
    return;
  }
  std::vector<const ContactTable*> tables;
  for (const DeviceScene* scene : bound_) tables.push_back(&scene->contacts);
  join(tables, first_places_, contacts_);
  step_->set_contacts(contacts_);
}

template <class Executor>
StepRules DeviceScenes<Executor>::rules_of(DeviceScene& scene) const {
  scene.rules.is_due = scene.is_due;
  scene.rules.embedded = scene.contacts.embedded && !scene.contacts.contacts.empty();
  scene.rules.delay = key_.delay;
  scene.rules.rho = std::min(scene.estimate, scene.rules.rho_bound);
  return scene.rules;
}

template <class Executor>
void DeviceScenes<Executor>::upload_rules() {
  std::vector<StepRules> rules;
  for (DeviceScene* scene : bound_) rules.push_back(rules_of(*scene));
  step_->set_rules(rules);
}

template <class Executor>
void DeviceScenes<Executor>::iterate() {
  if (bound_.empty() || key_.iterations == 0) return;
  // The step's own iterations begin without what contacts did in those.
  if (estimate()) upload_contacts();
  step_->run(key_.iterations);
  step_->executor().synchronize();
}

template <class Executor>
void DeviceScenes<Executor>::download() {
  if (bound_.empty() || key_.iterations == 0) return;
  const std::vector<StepControl> control = step_->control();
  step_->displacement(displacement_);
  step_->contact_forces(contacts_.forces);
  std::vector<std::size_t> first_forces(1, 0);
  for (const DeviceScene* scene : bound_) {
    first_forces.push_back(first_forces.back() + scene->contacts.forces.size());
  }
  for_each_scene([&](std::size_t s) {
    DeviceScene& scene = *bound_[s];
    scene.is_due = false;
    scene.control = control[s];
    std::copy_n(contacts_.forces.begin() + static_cast<std::ptrdiff_t>(first_forces[s]),
                scene.contacts.forces.size(), scene.contacts.forces.begin());
    take_back(displacement_, s, scene.displacement);
  });
}

/// The scenes of a batch, those of one key together.
template <class Executor>
class DeviceBatch final : public SolverBatch {
 public:
  std::shared_ptr<DeviceScenes<Executor>> scenes(const DeviceScenesKey& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    auto& found = groups_[key];
    if (!found) found = std::make_shared<DeviceScenes<Executor>>(key);
    return found;
  }
  void run() override {
    failure_.clear();
    try {
      for (const auto& group : groups_) group.second->run();
    } catch (const DeviceFailure& failure) {
      failure_ = failure.what();
    }
  }
  /// Of the last run; empty where all went well.
  const std::string& failure() const { return failure_; }

 private:
  std::mutex mutex_;
  std::map<DeviceScenesKey, std::shared_ptr<DeviceScenes<Executor>>> groups_;
  std::string failure_;
};

}  // namespace pliant

#include "cuda/solvers/scenes/device_scenes_estimate.h"
#include "cuda/solvers/scenes/device_scenes_resident.h"
