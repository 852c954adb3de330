#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "cuda/solvers/device_step.h"
#include "cuda/solvers/joined_system.h"
#include "pliant/core/parallel.h"
#include "pliant/solvers/backend.h"

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
  ContactTable contacts;       ///< of places in its own system
  StepRules rules;
  bool is_estimated = false;  ///< else the next step finds the spectral radius
  double estimate = 0.0;
  // After it.
  std::vector<Float4> displacement;
  StepControl control;
};

/// What all scenes of one launch have in common.
struct DeviceScenesKey {
  int iterations = 0;
  int delay = 0;  ///< plain iterations before acceleration
  int block = 0;

  bool operator<(const DeviceScenesKey& o) const {
    return std::tie(iterations, delay, block) < std::tie(o.iterations, o.delay, o.block);
  }
  bool operator==(const DeviceScenesKey& o) const { return !(*this < o) && !(o < *this); }
};

/// Scenes whose steps an executor computes at once. Solvers fill their scenes in any threads; one
/// thread runs them. A scene depends on no other, to the last bit; but when one of them changed,
/// the search for rotations of the others' tetrahedra begins anew, as after a change of their own.
template <class Executor>
class DeviceScenes {
 public:
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
  /// One step of each, and its three parts. Throws DeviceFailure.
  void run() {
    upload();
    iterate();
    download();
  }
  void upload();
  void iterate();
  void download();

 private:
  static constexpr int kPreSimulation = 40;  // as ChebyshevSolver
  // Small bodies have too few blocks to fill a GPU: several threads then share a particle's
  // elements. Large ones do best with few threads, since blocks wait for their slowest.
  static constexpr int kLarge = 40000;

  void bind();
  void upload_contacts();
  /// `only_unknown`: of those alone whose spectral radius is not known, the others rest.
  void upload_rules(bool only_unknown = false);
  /// The radius of a Jacobi iteration, from the changes of successive ones (as ChebyshevSolver).
  void estimate();
  std::size_t first_place(std::size_t number) const {
    return static_cast<std::size_t>(begins_[number] * key_.block);
  }
  /// Values of all scenes, each at its places; `fill` where one has none.
  template <class T>
  const std::vector<T>& at_places(std::vector<T> DeviceScene::*values, const T& fill,
                                  std::vector<T>& joined) const;

  DeviceScenesKey key_;
  std::mutex mutex_;
  std::deque<DeviceScene> scenes_;  // a deque, since solvers refer to theirs
  bool has_changed_ = false;
  std::unique_ptr<DeviceStep<Executor>> step_;
  std::vector<DeviceScene*> bound_;
  std::vector<int> begins_;  // first block of each bound scene, and the end
  bool has_anchors_ = false;
  std::vector<Fixed> joined_;
  std::vector<float> joined_mobility_;
  std::vector<Float4> displacement_;
  ContactTable contacts_;
};

template <class Executor>
void DeviceScenes<Executor>::bind() {
  bound_.clear();
  std::vector<const PackedSystem*> systems;
  for (DeviceScene& scene : scenes_) {
    if (!scene.is_there) continue;
    bound_.push_back(&scene);
    systems.push_back(&scene.packed);
  }
  step_.reset();  // its memory may be needed
  if (bound_.empty()) return;
  const PackedSystem joined = bound_.size() > 1 ? join(systems) : PackedSystem();
  const PackedSystem& packed = bound_.size() > 1 ? joined : *systems.front();
  begins_ = packed.scene_begins;
  step_ = std::make_unique<DeviceStep<Executor>>(packed, packed.particles >= kLarge ? 1 : 4);
  step_->set_mobility(at_places(&DeviceScene::mobility, 0.0f, joined_mobility_));
  has_anchors_ = false;
}

template <class Executor>
template <class T>
const std::vector<T>& DeviceScenes<Executor>::at_places(std::vector<T> DeviceScene::*values,
                                                        const T& fill,
                                                        std::vector<T>& joined) const {
  if (bound_.size() == 1) return bound_.front()->*values;
  joined.assign(first_place(bound_.size()), fill);
  parallel_for(0, static_cast<int>(bound_.size()), 16, [&](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      const auto number = static_cast<std::size_t>(s);
      const std::vector<T>& own = bound_[number]->*values;
      std::copy(own.begin(), own.end(),
                joined.begin() + static_cast<std::ptrdiff_t>(first_place(number)));
    }
  });
  return joined;
}

template <class Executor>
void DeviceScenes<Executor>::upload() {
  if (has_changed_) bind();
  has_changed_ = false;
  if (bound_.empty()) return;
  const Fixed zero = {0, 0, 0, 0.0f};
  step_->set_predicted(at_places(&DeviceScene::predicted, zero, joined_));
  step_->set_start(at_places(&DeviceScene::start, zero, joined_));
  const bool any = std::any_of(bound_.begin(), bound_.end(),
                               [](const DeviceScene* scene) { return !scene->anchors.empty(); });
  if (any) {
    step_->set_anchors(at_places(&DeviceScene::anchors, zero, joined_));
  } else if (has_anchors_) {
    step_->set_anchors({});
  }
  has_anchors_ = any;
  upload_contacts();
  upload_rules();
}

template <class Executor>
void DeviceScenes<Executor>::upload_contacts() {
  if (bound_.size() == 1) {
    step_->set_contacts(bound_.front()->contacts);
    return;
  }
  contacts_.contacts.clear();
  contacts_.forces.clear();
  contacts_.carried = false;
  for (std::size_t s = 0; s < bound_.size(); ++s) {
    const ContactTable& own = bound_[s]->contacts;
    const int first = static_cast<int>(first_place(s));
    for (DeviceContact contact : own.contacts) {
      for (int& particle : contact.particles.v) particle += particle >= 0 ? first : 0;
      contacts_.contacts.push_back(contact);
    }
    contacts_.forces.insert(contacts_.forces.end(), own.forces.begin(), own.forces.end());
    contacts_.carried = contacts_.carried || own.carried;
  }
  if (!contacts_.contacts.empty()) contacts_.index(static_cast<int>(first_place(bound_.size())));
  step_->set_contacts(contacts_);
}

template <class Executor>
void DeviceScenes<Executor>::upload_rules(bool only_unknown) {
  std::vector<StepRules> rules;
  for (DeviceScene* scene : bound_) {
    scene->rules.is_due = scene->is_due && !(only_unknown && scene->is_estimated);
    scene->rules.carried = scene->contacts.carried && !scene->contacts.contacts.empty();
    scene->rules.delay = key_.delay;
    scene->rules.rho = std::min(scene->estimate, scene->rules.rho_bound);
    rules.push_back(scene->rules);
  }
  step_->set_rules(rules);
}

template <class Executor>
void DeviceScenes<Executor>::estimate() {
  struct Search {
    double last = 0.0, ratio = 0.0;
    bool is_done = false;
  };
  std::vector<Search> searches;
  for (const DeviceScene* scene : bound_)
    searches.push_back({0.0, 0.0, scene->is_estimated || !scene->is_due});
  const auto is_done = [](const Search& search) { return search.is_done; };
  if (std::all_of(searches.begin(), searches.end(), is_done)) return;
  upload_rules(true);
  for (int k = 0; k < kPreSimulation; ++k) {
    const std::vector<double> squared = step_->plain_iteration(k);
    for (std::size_t s = 0; s < bound_.size(); ++s) {
      Search& search = searches[s];
      if (search.is_done) continue;
      // |D^-1/2 r| from |J(y) - y|² / γ.
      const StepRules& rules = bound_[s]->rules;
      search.is_done = std::sqrt(squared[s] / rules.gamma) <= rules.noise;
      if (search.is_done) continue;
      if (search.last > 0.0) search.ratio = std::sqrt(squared[s] / search.last);
      search.last = squared[s];
    }
  }
  for (std::size_t s = 0; s < bound_.size(); ++s) {
    // A body in free fall says nothing.
    if (bound_[s]->is_estimated || searches[s].last == 0.0) continue;
    bound_[s]->estimate = searches[s].ratio;
    bound_[s]->is_estimated = true;
  }
  upload_rules();
}

template <class Executor>
void DeviceScenes<Executor>::iterate() {
  if (bound_.empty() || key_.iterations == 0) return;
  if (key_.iterations > key_.delay) estimate();
  step_->run(key_.iterations);
  step_->executor().synchronize();
}

template <class Executor>
void DeviceScenes<Executor>::download() {
  if (bound_.empty() || key_.iterations == 0) return;
  const std::vector<StepControl> control = step_->control();
  step_->displacement(displacement_);
  step_->contact_forces(contacts_.forces);
  auto force = contacts_.forces.begin();
  for (std::size_t s = 0; s < bound_.size(); ++s) {
    DeviceScene& scene = *bound_[s];
    scene.is_due = false;
    scene.control = control[s];
    const auto count = static_cast<std::ptrdiff_t>(scene.contacts.forces.size());
    std::copy(force, force + count, scene.contacts.forces.begin());
    force += count;
  }
  parallel_for(0, static_cast<int>(bound_.size()), 16, [&](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      DeviceScene& scene = *bound_[static_cast<std::size_t>(s)];
      const auto first = displacement_.begin() +
                         static_cast<std::ptrdiff_t>(first_place(static_cast<std::size_t>(s)));
      scene.displacement.assign(first,
                                first + static_cast<std::ptrdiff_t>(scene.packed.order.size()));
    }
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
