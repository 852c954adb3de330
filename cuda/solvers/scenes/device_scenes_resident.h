#pragma once

#include "cuda/solvers/scenes/device_scenes.h"

/// Steps of DeviceScenes between which nothing leaves the executor.
namespace pliant {

template <class Executor>
int DeviceScenes<Executor>::resident_steps() const {
  int steps = 0;
  for (const DeviceScene& scene : scenes_) {
    if (scene.is_there && scene.is_due) steps = std::max(steps, scene.resident_steps);
  }
  return steps;
}

template <class Executor>
int DeviceScenes<Executor>::resident_substeps() const {
  return bound_.size() == 1 ? bound_.front()->resident_substeps : 1;
}

template <class Executor>
void DeviceScenes<Executor>::run_resident(int steps) {
  if (following_ != steps) {
    bind_if_changed();
    bind_resident_run();
    upload_resident_run();
    if (key_.iterations > key_.delay && is_any_unknown()) {
      resident_run_->predict();
      estimate();
    }
    resident_run_->launch(key_.iterations, steps, resident_substeps());
  }
  following_ = 0;
  download_resident_run(resident_run_->finish());
}

template <class Executor>
bool DeviceScenes<Executor>::may_follow() const {
  if (bound_.size() != 1 || forces_) return false;
  const DeviceScene& scene = *bound_.front();
  return scene.resident_follow >= 2 && scene.tally.failed == 0 && scene.is_estimated;
}

template <class Executor>
void DeviceScenes<Executor>::launch_following() {
  if (!may_follow()) return;
  following_ = bound_.front()->resident_follow;
  resident_run_->launch_more(key_.iterations, following_, resident_substeps());
}

template <class Executor>
void DeviceScenes<Executor>::bind_resident_run() {
  std::size_t slots = 0;
  for (const DeviceScene* scene : bound_) slots = std::max(slots, scene->obstacles.size());
  const auto needed = static_cast<int>(slots);
  if (resident_run_ && resident_run_->slots() >= needed) return;
  resident_run_.reset();
  resident_run_ = std::make_unique<DeviceResidentRun<Executor>>(*step_, needed);
}

template <class Executor>
void DeviceScenes<Executor>::upload_resident_run() {
  at_places(&DeviceScene::now, now_, [&](const auto& now) {
    at_places(&DeviceScene::velocity, velocity_, [&](const auto& velocity) {
      at_places(&DeviceScene::velocity_before, velocity_before_,
                [&](const auto& before) { resident_run_->set_state(now, velocity, before); });
    });
  });
  std::vector<ResidentRules> rules;
  std::vector<DeviceObstacle> obstacles;
  for (DeviceScene* scene : bound_) {
    scene->resident_rules.first_obstacle = static_cast<int>(obstacles.size());
    scene->resident_rules.obstacles = static_cast<int>(scene->obstacles.size());
    rules.push_back(scene->resident_rules);
    for (std::size_t k = 0; k < scene->obstacles.size(); ++k) {
      obstacles.push_back(scene->obstacles[k]);
      obstacles.back().shape.grid.samples = grids_.samples(step_->executor(), scene->shapes[k]);
    }
  }
  upload_anchors();
  resident_run_->set_rules(rules, obstacles);
  upload_components();
  upload_rules();
  resident_run_->set_forces(bound_.size() == 1 ? forces_ : nullptr);
}

template <class Executor>
void DeviceScenes<Executor>::upload_components() {
  std::vector<int> members, begins(1, 0);
  for (std::size_t s = 0; s < bound_.size(); ++s) {
    const DeviceScene& scene = *bound_[s];
    const int before = static_cast<int>(members.size());
    for (const int place : scene.component_members) members.push_back(first_places_[s] + place);
    for (std::size_t c = 1; c < scene.component_begins.size(); ++c) {
      begins.push_back(before + scene.component_begins[c]);
    }
  }
  resident_run_->set_components(members, begins);
}

template <class Executor>
void DeviceScenes<Executor>::download_resident_run(int taken) {
  const std::vector<StepControl> control = step_->control();
  const std::vector<ResidentTally> tally = resident_run_->tally();
  std::vector<int> begins;
  for (int place : first_places_) begins.push_back(place / key_.block);
  const auto reactions = resident_run_->reactions(begins);
  for_each_scene([&](std::size_t s) {
    DeviceScene& scene = *bound_[s];
    if (!scene.is_due) return;
    scene.resident_steps = 0;
    scene.taken = taken;
    scene.control = control[s];
    scene.tally = tally[s];
    scene.reactions = reactions[s];
  });
  // What fails alone is undone: the state that was kept before may still be read back.
  const bool is_undone = bound_.size() == 1 && tally.front().failed != 0;
  if (!is_undone) {
    const Readback readback = actual_readback();
    resident_run_->keep_state();
    begin_readback(readback);
    launch_following();
    resident_run_->end_state();
    take_readback(readback);
  }
  for (DeviceScene* scene : bound_) scene->is_due = false;
}

template <class Executor>
Readback DeviceScenes<Executor>::actual_readback() const {
  // What does not go on from here is uploaded again.
  if (!may_follow()) return Readback::kState;
  const Readback readback = bound_.front()->readback;
  // What is held pulls at obstacles by where it is.
  return has_anchors_ ? std::max(readback, Readback::kMotion) : readback;
}

template <class Executor>
void DeviceScenes<Executor>::begin_readback(Readback readback) {
  const PackedSystem& packed = bound_.front()->packed;
  if (readback < Readback::kMotion)
    resident_run_->begin_extent(static_cast<int>(packed.order.size()), extents_);
  if (readback == Readback::kSurface) {
    resident_run_->begin_surface(bound_.front()->surface, packed.place, surface_);
  }
  if (readback >= Readback::kMotion) resident_run_->begin_motion(now_, velocity_);
  if (readback == Readback::kState) resident_run_->begin_rest(was_, velocity_before_);
}

template <class Executor>
void DeviceScenes<Executor>::take_readback(Readback readback) {
  for_each_scene([&](std::size_t s) {
    DeviceScene& scene = *bound_[s];
    if (!scene.is_due) return;
    scene.available = readback;
    if (readback < Readback::kMotion) {
      scene.extent = extents_[0];
      for (const ResidentExtent& extent : extents_) scene.extent.add(extent);
      return;
    }
    take_back(now_, s, scene.now);
    take_back(velocity_, s, scene.velocity);
    if (readback < Readback::kState) return;
    take_back(was_, s, scene.was);
    take_back(velocity_before_, s, scene.velocity_before);
  });
}

template <class Executor>
void DeviceScenes<Executor>::read_back_state() {
  DeviceScene& scene = *bound_.front();
  begin_readback(Readback::kState);
  resident_run_->end_state();
  scene.is_due = true;
  take_readback(Readback::kState);
  scene.is_due = false;
}

}  // namespace pliant
