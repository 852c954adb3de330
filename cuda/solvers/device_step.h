#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cuda/core/upload.h"
#include "cuda/elements/cluster_arrays.h"
#include "cuda/solvers/blocks/persistent_iteration.h"
#include "cuda/solvers/clusters/cluster_fit.h"
#include "cuda/solvers/contact/contact_table.h"
#include "cuda/solvers/contact/embedded_contacts.h"
#include "cuda/solvers/iteration.h"
#include "cuda/solvers/matrix/matrix_arrays.h"
#include "cuda/solvers/matrix/multigrid_cycle.h"
#include "cuda/solvers/matrix/quasi_newton_arrays.h"
#include "cuda/solvers/scenes/packed_system.h"
#include "cuda/solvers/step_control.h"

namespace pliant {

/// The iterations of one implicit Euler step on a packed system, in the memory of an executor
/// (core/host_executor.h, core/cuda_executor.cuh). Of each scene in it on its own: what one does
/// changes nothing in another.
template <class Executor>
class DeviceStep {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// `threads_per_particle` share the work on a block's simplices.
  explicit DeviceStep(const PackedSystem& packed, int threads_per_particle = 1);

  Executor& executor() { return executor_; }
  const StepArrays& arrays() const { return arrays_; }
  int blocks() const { return blocks_; }
  int particles() const { return arrays_.particles; }
  int scenes() const { return scenes_; }
  /// Whether an iteration is a sweep over colours.
  bool sweeps() const { return matrix_.kind() == DeviceIteration::kSweep; }
  /// γ/D of each place, 0 for a fixed particle [m/N].
  template <class Values>
  void set_mobility(const Values& mobility) {
    put(mobility_, mobility);
  }
  /// Mean target and Σ k of the attachments of each place; empty: none.
  template <class Values>
  void set_anchors(const Values& anchors) {
    arrays_.anchors = anchors.empty() ? nullptr : put(anchors_, anchors);
  }
  /// What list_spins() tells of the packed clusters, which are oriented.
  void set_spins(const std::vector<float>& spins) { clusters_.set_spins(executor_, spins); }
  void set_contacts(const ContactTable& table);  ///< indexed
  /// Of points that share no particles, in the executor's memory.
  void set_contacts(const ContactsView& view);
  /// Prediction y with M/h², and the first iterate.
  template <class Values>
  void set_predicted(const Values& predicted) {
    put(predicted_, predicted);
  }
  template <class Values>
  void set_start(const Values& start) {
    put(start_, start);
  }
  /// One a scene; all have the same delay.
  void set_rules(const std::vector<StepRules>& rules);

  /// All of them, and what decides between them. Where nothing but numbers changed since the last
  /// call, a graph is replayed.
  void run(int iterations);
  /// A plain iteration, the `number`th, on its own; returns |J(y) - y|² / γ in the norm of D of
  /// each scene.
  std::vector<double> plain_iteration(int number);

  /// x - y of the result at each place.
  template <class Values>
  void displacement(Values& result) {
    result.resize(x0_.size());
    executor_.download(result.data(), result_, result.size());
  }
  std::vector<StepControl> control();  ///< of each scene
  void contact_forces(std::vector<DeviceContactForce>& forces);

  // For those who keep the state where the iterations run: what set_predicted() and set_start()
  // fill, and what displacement() downloads.
  Fixed* predicted() { return predicted_.data(); }
  Fixed* start() { return start_.data(); }
  StepRules* rules() { return rules_.data(); }
  const Float4* result() const { return result_.data(); }

  // For those who time and profile: what run() replays, and one iteration on the state as it is.
  const typename Executor::Graph& graph() const { return graph_; }
  void launch_iteration(int number, int place, bool measured);
  void launch_begin();
  /// All iterations, from the beginning, and control.
  void launch_iterations(int iterations);

 private:
  void bind_scenes();
  struct SimplexArrays {
    Array<int> begins;
    Array<UShort4> places, slots;
    Array<Float4> numbers;
    Array<PackedRotation> rotation;
  };
  struct RowArrays {
    Array<int> begins;
    Array<unsigned short> neighbors;
    Array<float> a, b;
  };
  void bind_elements(const PackedSystem& packed);
  void plan_persistent(const PackedSystem& packed);
  void bind_rows(const LocalRows& rows, RowArrays& to, LocalRowsView& view);
  void bind_simplices(const PackedSimplices& simplices, int copies, SimplexArrays& to,
                      SimplicesView& view);
  BlockForces block_forces() const { return {elements_, threads_, shared_}; }
  template <class T, class Values>
  T* put(Array<T>& array, const Values& values) {
    if (upload_all(executor_, array, values)) ++allocations_;  // captured graphs know the old ones
    return array.data();
  }
  void capture(int iterations);
  /// Iterations on end, of which the last one is measured.
  void launch_interval(int first, int count);
  /// All of them in one launch; false where not all blocks run at the same time.
  bool launch_persistent(const IterationPlan& plan);
  void launch_carried();
  // Iterations that read the matrix: device_step_matrix.h.
  void launch_gradient_step(const Acceleration& iteration);
  void launch_weighted(const Acceleration& iteration);
  void launch_sweep(const Acceleration& iteration);
  // Those of L-BFGS: device_step_quasi_newton.h.
  static constexpr int kRun = 8;  ///< iterations of a launch, where there are more
  void run_quasi_newton(int iterations);
  void launch_quasi_newton_begin(int iterations);
  void launch_quasi_newton(int count, int iterations);
  void launch_judged(JudgeStep::Where where, int iterations);
  void launch_touches(int count, int iterations);
  void launch_direction();
  bool is_quasi_newton() const { return matrix_.kind() == DeviceIteration::kQuasiNewton; }
  void launch_control(const StepDecision& decide);

  Executor executor_;
  typename Executor::Graph graph_;
  typename Executor::Graph more_;  ///< of L-BFGS: iterations after the first ones
  // What a captured graph holds of its own: pointers are those of its allocations.
  struct Launched {
    int iterations = -1, delay = 0;
    bool embedded = false, spread = false, any = false, anchored = false;
    std::uint64_t allocations = 0;
    bool operator==(const Launched& o) const {
      return iterations == o.iterations && delay == o.delay && embedded == o.embedded &&
             spread == o.spread && any == o.any && anchored == o.anchored &&
             allocations == o.allocations;
    }
  };
  Launched captured_;
  std::uint64_t allocations_ = 0;
  int delay_ = 0;
  static constexpr std::size_t kMostOfBlock = 256;     // contacts
  static constexpr int kLeastPersistentThreads = 384;  // of a block

  int blocks_ = 0, threads_ = 0, scenes_ = 0;
  BlockShared shared_;
  SharedMemoryPlaces shared_places_;  ///< of PersistentIteration; empty: not for this system
  std::vector<int> scene_begins_;
  bool embedded_ = false, spread_ = false;
  std::size_t contact_count_ = 0;
  StepArrays arrays_;
  ElementsView elements_;
  ContactsView contacts_;
  Array<int> border_begins_, border_places_, slot_begins_;
  Array<float> mobility_, partial_;
  RowArrays springs_, cells_, quadratic_;
  SimplexArrays tetrahedra_, fibers_, triangles_;
  ClusterArrays<Executor> clusters_;
  MatrixArrays<Executor> matrix_;
  QuasiNewtonArrays<Executor> quasi_newton_;
  MultigridArrays<Executor> multigrid_;
  Array<MembraneConstants<float>> materials_;
  Array<Fixed> x0_, x1_, predicted_, start_, anchors_, raw_, pushed_, projected_, saved_[2];
  Array<Fixed> mailboxes_;  ///< of PersistentIteration
  Array<Float4> result_;
  Array<StepControl> control_;
  Array<StepRules> rules_;
  Array<DeviceContact> contact_array_;
  Array<DeviceContactForce> contact_forces_;
  Array<int> contact_begins_, touched_, touched_begins_, entries_, first_;
  Array<int> scene_of_block_, block_begins_;
};

template <class Executor>
DeviceStep<Executor>::DeviceStep(const PackedSystem& packed, int threads_per_particle) {
  const auto n = static_cast<std::size_t>(packed.particles);
  arrays_.particles = packed.particles;
  arrays_.block = packed.block;
  blocks_ = packed.blocks;
  threads_ = packed.block * (packed.most_slots > 0 ? threads_per_particle : 1);
  threads_ = std::max(packed.block, std::min(threads_, BlockForces::kMostThreads));
  bind_elements(packed);
  clusters_.bind(executor_, packed.clusters, packed.particles, elements_.clusters);
  matrix_.bind(executor_, packed.matrix, packed.particles, packed.blocks);
  plan_persistent(packed);
  multigrid_.bind(executor_, packed.matrix.multigrids);
  quasi_newton_.bind(packed.matrix, packed.particles, packed.blocks, packed.scenes());
  for (Array<Fixed>* array :
       {&x0_, &x1_, &predicted_, &start_, &projected_, &saved_[0], &saved_[1]}) {
    array->resize(n);
  }
  result_.resize(n);
  mobility_.resize(n);
  partial_.resize(static_cast<std::size_t>(blocks_ * std::max<int>(kMeasures, kForceMeasures)));
  scenes_ = packed.scenes();
  scene_begins_ = packed.scene_begins;
  put(block_begins_, scene_begins_);
  control_.resize(static_cast<std::size_t>(scenes_));
  rules_.resize(static_cast<std::size_t>(scenes_));
  bind_scenes();
  arrays_.x[0] = x0_.data();
  arrays_.x[1] = x1_.data();
  arrays_.predicted = predicted_.data();
  arrays_.mobility = mobility_.data();
  arrays_.projected = projected_.data();
  arrays_.saved[0] = saved_[0].data();
  arrays_.saved[1] = saved_[1].data();
  arrays_.partial = partial_.data();
  arrays_.control = control_.data();
  arrays_.rules = rules_.data();
}

template <class Executor>
void DeviceStep<Executor>::set_contacts(const ContactTable& table) {
  contacts_ = {};
  embedded_ = table.embedded && !table.contacts.empty();
  // Threads of one block wait for each other within a kernel; more of them between kernels.
  spread_ = embedded_ && scenes_ == 1 && table.contacts.size() > kMostOfBlock;
  contact_count_ = table.contacts.size();
  if (table.contacts.empty()) return;
  contacts_.any = true;
  contacts_.begins_of_scenes = put(contact_begins_, table.begins_of_scenes);
  contacts_.contacts = put(contact_array_, table.contacts);
  contacts_.forces = put(contact_forces_, table.forces);
  contacts_.touched = put(touched_, table.touched);
  contacts_.begins = put(touched_begins_, table.begins);
  contacts_.entries = put(entries_, table.entries);
  contacts_.first = put(first_, table.first);
  if (embedded_ && raw_.size() == 0) {
    raw_.resize(x0_.size());
    pushed_.resize(x0_.size());
    ++allocations_;
    arrays_.raw = raw_.data();
    arrays_.pushed = pushed_.data();
  }
}

template <class Executor>
void DeviceStep<Executor>::set_contacts(const ContactsView& view) {
  contacts_ = view;
  embedded_ = spread_ = false;
  contact_count_ = 0;
  captured_ = {};  // its graph knows the contacts of a table
}

template <class Executor>
void DeviceStep<Executor>::set_rules(const std::vector<StepRules>& rules) {
  delay_ = rules.front().delay;
  put(rules_, rules);
}

template <class Executor>
void DeviceStep<Executor>::run(int iterations) {
  const Launched wanted = {iterations,  delay_,        embedded_,
                           spread_,     contacts_.any, arrays_.anchors != nullptr,
                           allocations_};
  if (!(captured_ == wanted)) {
    capture(iterations);
    captured_ = wanted;
  }
  if (is_quasi_newton()) return run_quasi_newton(iterations);
  executor_.replay(graph_);
}

template <class Executor>
std::vector<double> DeviceStep<Executor>::plain_iteration(int number) {
  if (number == 0) launch_begin();
  launch_iteration(number, 0, true);
  std::vector<float> partial(partial_.size());
  executor_.download(partial.data(), partial_, partial.size());
  std::vector<double> sums(static_cast<std::size_t>(scenes_), 0.0);
  for (std::size_t scene = 0; scene < sums.size(); ++scene) {
    for (int b = scene_begins_[scene]; b < scene_begins_[scene + 1]; ++b) {
      sums[scene] += partial[static_cast<std::size_t>(b * kMeasures + kChange)];
    }
  }
  return sums;
}

template <class Executor>
std::vector<StepControl> DeviceStep<Executor>::control() {
  std::vector<StepControl> control(static_cast<std::size_t>(scenes_));
  executor_.download(control.data(), control_, control.size());
  return control;
}

template <class Executor>
void DeviceStep<Executor>::contact_forces(std::vector<DeviceContactForce>& forces) {
  forces.resize(contact_count_);
  if (!forces.empty()) executor_.download(forces.data(), contact_forces_, forces.size());
}

}  // namespace pliant

#include "cuda/solvers/device_step_bind.h"
#include "cuda/solvers/device_step_launch.h"
#include "cuda/solvers/device_step_matrix.h"
#include "cuda/solvers/device_step_quasi_newton.h"
