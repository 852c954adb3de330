#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include "cuda/core/embedded_points.h"
#include "cuda/core/upload.h"
#include "cuda/solvers/device_step.h"
#include "cuda/solvers/resident_run/device_balance.h"
#include "cuda/solvers/resident_run/resident_extent.h"
#include "cuda/solvers/resident_run/resident_forces.h"
#include "cuda/solvers/resident_run/resident_sums.h"

namespace pliant {

/// A resident run of all scenes of a DeviceStep: steps on end between which nothing leaves the
/// executor.
template <class Executor>
class DeviceResidentRun {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// `slots`: obstacles of the scene that has most of them. `step` outlives this.
  DeviceResidentRun(DeviceStep<Executor>& step, int slots);

  int slots() const { return resident_.slots; }
  /// Before run(): position with M/h² of each place, velocities now and when the last step began.
  template <class Positions, class Velocities>
  void set_state(const Positions& now, const Velocities& velocity, const Velocities& before) {
    upload_all(step_.executor(), now_, now);
    upload_all(step_.executor(), velocity_, velocity);
    upload_all(step_.executor(), before_, before);
  }
  /// One a scene, and all their obstacles.
  void set_rules(const std::vector<ResidentRules>& rules,
                 const std::vector<DeviceObstacle>& obstacles);
  /// The places of each connected component that nothing holds from outside, and where these begin,
  /// with the end.
  void set_components(const std::vector<int>& members, const std::vector<int>& begins);
  /// What acts besides, where there is one scene; null: nothing. Follows set_state() and
  /// set_rules().
  void set_forces(std::shared_ptr<ResidentForces<Executor>> forces);
  /// The first prediction, for those who measure a plain iteration before.
  void predict() {
    if (forces_) forces_->before_substep(step_.executor());
    launch_prediction();
  }
  /// Begins with so many steps, each in so many substeps; they are under way on return, or done
  /// where other forces act.
  void launch(int iterations, int steps, int substeps);
  /// Likewise from where the last ones ended, with their rules.
  void launch_more(int iterations, int steps, int substeps);
  /// Returns how many of them it took, once they are done.
  int finish();

  /// Keeps the state at the end of the last steps. Then all of it or a part; it is there on return
  /// of end_state(): what is launched in between runs beside it.
  void keep_state();
  template <class Positions, class Velocities>
  void begin_motion(Positions& now, Velocities& velocity);
  template <class Positions, class Velocities>
  void begin_rest(Positions& was, Velocities& before);
  /// Null: the points are the particles. `place`: of each particle.
  template <class Points>
  void begin_surface(const EmbeddedPoints* surface, const std::vector<int>& place, Points& points);
  /// Of runs of so many particles.
  template <class Extents>
  void begin_extent(int particles, Extents& of_runs);
  void end_state() { step_.executor().finish_downloads(); }
  std::vector<ResidentTally> tally();
  /// Of the last step: kReactionNumbers a slot, of each scene.
  std::vector<std::vector<double>> reactions(const std::vector<int>& scene_begins);

  // What a substep consists of, for those who time it.
  DeviceStep<Executor>& step() { return step_; }
  void launch_forces(int substeps);
  void launch_prediction();
  void launch_end(int substeps);

 private:
  void bind_contacts();
  void capture(int iterations, int substeps);
  void sum_reactions(float share);
  bool goes_on();

  DeviceStep<Executor>& step_;
  std::shared_ptr<ResidentForces<Executor>> forces_;
  typename Executor::Graph graph_;  // of a substep
  const Fixed* captured_anchors_ = nullptr;
  ResidentArrays resident_;
  Array<Fixed> now_, was_;
  Array<Float4> velocity_, before_, left_;
  Array<Fixed> seen_now_, seen_was_;  // copies, that the next steps do not change
  Array<Float4> seen_velocity_, seen_before_;
  DeviceEmbeddedPoints<Executor> surface_;
  Array<ResidentExtent> extents_;
  int taken_ = 0;
  DeviceBalance<Executor> balance_;
  Array<DeviceContact> contacts_;
  Array<DeviceContactForce> contact_forces_;
  Array<int> first_, begins_, entries_;
  Array<ResidentRules> rules_;
  Array<ResidentTally> tally_;
  Array<DeviceObstacle> obstacles_;
  Array<float> sums_, fastest_;
};

template <class Executor>
DeviceResidentRun<Executor>::DeviceResidentRun(DeviceStep<Executor>& step, int slots)
    : step_(step) {
  const auto n = static_cast<std::size_t>(step.particles());
  const auto scenes = static_cast<std::size_t>(step.scenes());
  for (Array<Fixed>* array : {&now_, &was_}) array->resize(n);
  for (Array<Float4>* array : {&velocity_, &before_, &left_}) array->resize(n);
  rules_.resize(scenes);
  tally_.resize(scenes);
  obstacles_.resize(scenes * static_cast<std::size_t>(slots));
  resident_.slots = slots;
  if (slots > 0) bind_contacts();
  resident_.now = now_.data();
  resident_.was = was_.data();
  resident_.velocity = velocity_.data();
  resident_.before = before_.data();
  resident_.left = left_.data();
  resident_.predicted = step.predicted();
  resident_.start = step.start();
  resident_.contacts = contacts_.data();
  resident_.forces = contact_forces_.data();
  resident_.first = first_.data();
  resident_.rules = rules_.data();
  resident_.tally = tally_.data();
  resident_.step_rules = step.rules();
  resident_.obstacles = obstacles_.data();
}

template <class Executor>
void DeviceResidentRun<Executor>::bind_contacts() {
  const auto n = static_cast<std::size_t>(step_.particles());
  const std::size_t count = n * static_cast<std::size_t>(resident_.slots);
  contacts_.resize(count);
  contact_forces_.resize(count);
  first_.resize(n);
  std::vector<int> begins(n + 1), entries(count);
  for (std::size_t i = 0; i <= n; ++i) begins[i] = static_cast<int>(i) * resident_.slots;
  for (std::size_t k = 0; k < count; ++k) entries[k] = 4 * static_cast<int>(k);
  upload_all(step_.executor(), begins_, begins);
  upload_all(step_.executor(), entries_, entries);
  step_.executor().synchronize();
  sums_.resize(static_cast<std::size_t>(step_.blocks() * kReactionNumbers * resident_.slots));
}

template <class Executor>
void DeviceResidentRun<Executor>::set_rules(const std::vector<ResidentRules>& rules,
                                            const std::vector<DeviceObstacle>& obstacles) {
  upload_all(step_.executor(), rules_, rules);
  upload_all(step_.executor(), obstacles_, obstacles);
  const std::vector<ResidentTally> none(tally_.size());
  upload_all(step_.executor(), tally_, none);
  ContactsView view;
  view.any = resident_.slots > 0;
  view.contacts = contacts_.data();
  view.forces = contact_forces_.data();
  view.begins = begins_.data();
  view.entries = entries_.data();
  view.first = first_.data();
  step_.set_contacts(view);
  step_.executor().synchronize();  // what was uploaded may go
}

template <class Executor>
void DeviceResidentRun<Executor>::set_components(const std::vector<int>& members,
                                                 const std::vector<int>& begins) {
  // A captured graph knows the last ones.
  if (balance_.bind(step_, members, begins, resident_)) graph_ = {};
}

template <class Executor>
void DeviceResidentRun<Executor>::set_forces(std::shared_ptr<ResidentForces<Executor>> forces) {
  if (forces_ || forces) graph_ = {};  // it knows the numbers of the last run
  forces_ = std::move(forces);
  resident_.pulls = nullptr;
  if (!forces_) return;
  const auto runs = static_cast<std::size_t>(step_.particles() / FindFastest::kThreads + 1);
  if (fastest_.size() < runs) fastest_.resize(runs);
  forces_->upload(step_.executor(), step_.arrays(), resident_);
}

template <class Executor>
void DeviceResidentRun<Executor>::launch_forces(int substeps) {
  if (!forces_) return;
  forces_->before_substep(step_.executor());
  if (resident_.slots > 0) {
    forces_->add_reactions(step_.executor(), 1.0f / static_cast<float>(substeps), sums_.data());
  }
}

template <class Executor>
void DeviceResidentRun<Executor>::launch_prediction() {
  step_.executor().launch(step_.particles(), PredictStep{step_.arrays(), resident_});
  step_.executor().launch(step_.particles(), StartStep{step_.arrays(), resident_});
  balance_.launch_start(step_, resident_);
}

template <class Executor>
void DeviceResidentRun<Executor>::launch_end(int substeps) {
  Executor& executor = step_.executor();
  balance_.launch_end(step_, resident_);
  executor.launch(step_.particles(), EndStep{step_.arrays(), resident_});
  if (forces_) {
    forces_->after_substep(executor);
    sum_reactions(1.0f / static_cast<float>(substeps));
  }
  executor.launch(step_.scenes(), TallyStep{step_.arrays(), resident_});
}

template <class Executor>
void DeviceResidentRun<Executor>::sum_reactions(float share) {
  if (resident_.slots == 0) return;
  const int block = step_.arrays().block;
  step_.executor().launch_blocks(step_.blocks(), block, block * kReactionNumbers * resident_.slots,
                                 SumReactions{step_.arrays(), resident_, share, sums_.data()});
}

template <class Executor>
void DeviceResidentRun<Executor>::capture(int iterations, int substeps) {
  const Fixed* anchors = step_.arrays().anchors;
  if (graph_ && anchors == captured_anchors_) return;
  captured_anchors_ = anchors;
  graph_ = step_.executor().capture([this, iterations, substeps] {
    launch_forces(substeps);
    launch_prediction();
    step_.launch_iterations(iterations);
    launch_end(substeps);
  });
}

template <class Executor>
bool DeviceResidentRun<Executor>::goes_on() {
  if (!forces_ || !forces_->watches_speed()) return true;
  const int runs = (step_.particles() + FindFastest::kThreads - 1) / FindFastest::kThreads;
  step_.executor().launch_blocks(
      runs, FindFastest::kThreads, FindFastest::kThreads,
      FindFastest{resident_.velocity, step_.particles(), fastest_.data()});
  step_.executor().launch_blocks(1, FindFastestOfRuns::kThreads, FindFastestOfRuns::kThreads,
                                 FindFastestOfRuns{fastest_.data(), runs, tally_.data()});
  const ResidentTally now = tally().front();
  return now.failed == 0 && forces_->goes_on(now.fastest);
}

template <class Executor>
void DeviceResidentRun<Executor>::launch(int iterations, int steps, int substeps) {
  Executor& executor = step_.executor();
  capture(iterations, substeps);
  const auto clear = [&] {
    executor.launch(static_cast<int>(sums_.size()), ClearSums{sums_.data()});
  };
  taken_ = 0;
  for (bool goes = true; taken_ < steps && goes; ++taken_) {
    // Which step will be the last one is not known before.
    if (forces_) clear();
    for (int k = 0; k < substeps; ++k) executor.replay(graph_);
    goes = goes_on();
  }
  if (forces_) return;
  clear();
  sum_reactions(1.0f);
}

template <class Executor>
void DeviceResidentRun<Executor>::launch_more(int iterations, int steps, int substeps) {
  step_.executor().launch(step_.scenes(), ClearTally{tally_.data()});
  launch(iterations, steps, substeps);
}

template <class Executor>
int DeviceResidentRun<Executor>::finish() {
  step_.executor().synchronize();
  return taken_;
}

template <class Executor>
std::vector<ResidentTally> DeviceResidentRun<Executor>::tally() {
  std::vector<ResidentTally> tally(tally_.size());
  step_.executor().download(tally.data(), tally_, tally.size());
  return tally;
}

template <class Executor>
std::vector<std::vector<double>> DeviceResidentRun<Executor>::reactions(
    const std::vector<int>& scene_begins) {
  const auto count = static_cast<std::size_t>(kReactionNumbers * resident_.slots);
  std::vector<float> sums(sums_.size());
  if (!sums.empty()) step_.executor().download(sums.data(), sums_, sums.size());
  std::vector<std::vector<double>> reactions(scene_begins.size() - 1,
                                             std::vector<double>(count, 0.0));
  for (std::size_t s = 0; s < reactions.size(); ++s) {
    for (int b = scene_begins[s]; b < scene_begins[s + 1]; ++b) {
      for (std::size_t k = 0; k < count; ++k) {
        reactions[s][k] += sums[static_cast<std::size_t>(b) * count + k];
      }
    }
  }
  return reactions;
}

}  // namespace pliant

#include "cuda/solvers/resident_run/device_resident_run_readback.h"
