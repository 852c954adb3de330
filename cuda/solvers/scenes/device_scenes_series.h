#pragma once

#include "cuda/solvers/scenes/device_scenes.h"

/// Steps of DeviceScenes between which nothing leaves the executor.
namespace pliant {

template <class Executor>
int DeviceScenes<Executor>::series_steps() const {
  int steps = 0;
  for (const DeviceScene& scene : scenes_) {
    if (scene.is_there && scene.is_due) steps = std::max(steps, scene.series_steps);
  }
  return steps;
}

template <class Executor>
int DeviceScenes<Executor>::series_parts() const {
  return bound_.size() == 1 ? bound_.front()->series_parts : 1;
}

template <class Executor>
void DeviceScenes<Executor>::run_series(int steps) {
  if (following_ != steps) {
    bind_if_changed();
    bind_series();
    upload_series();
    if (key_.iterations > key_.delay && is_any_unknown()) {
      series_->predict();
      estimate();
    }
    series_->launch(key_.iterations, steps, series_parts());
  }
  following_ = 0;
  download_series(series_->finish());
}

template <class Executor>
bool DeviceScenes<Executor>::may_follow() const {
  if (bound_.size() != 1 || forces_) return false;
  const DeviceScene& scene = *bound_.front();
  return scene.series_follow >= 2 && scene.tally.failed == 0 && scene.is_estimated;
}

template <class Executor>
void DeviceScenes<Executor>::launch_following() {
  if (!may_follow()) return;
  following_ = bound_.front()->series_follow;
  series_->launch_more(key_.iterations, following_, series_parts());
}

template <class Executor>
void DeviceScenes<Executor>::bind_series() {
  std::size_t slots = 0;
  for (const DeviceScene* scene : bound_) slots = std::max(slots, scene->obstacles.size());
  const auto wanted = static_cast<int>(slots);
  if (series_ && series_->slots() >= wanted) return;
  series_.reset();
  series_ = std::make_unique<DeviceSeries<Executor>>(*step_, wanted);
}

template <class Executor>
void DeviceScenes<Executor>::upload_series() {
  at_places(&DeviceScene::now, now_, [&](const auto& now) {
    at_places(&DeviceScene::way, way_, [&](const auto& way) {
      at_places(&DeviceScene::way_before, way_before_,
                [&](const auto& before) { series_->set_state(now, way, before); });
    });
  });
  std::vector<SeriesRules> rules;
  std::vector<DeviceObstacle> obstacles;
  for (DeviceScene* scene : bound_) {
    scene->series_rules.first_obstacle = static_cast<int>(obstacles.size());
    scene->series_rules.obstacles = static_cast<int>(scene->obstacles.size());
    rules.push_back(scene->series_rules);
    for (std::size_t k = 0; k < scene->obstacles.size(); ++k) {
      obstacles.push_back(scene->obstacles[k]);
      obstacles.back().shape.grid.samples = grids_.samples(step_->executor(), scene->shapes[k]);
    }
  }
  upload_anchors();
  series_->set_rules(rules, obstacles);
  upload_components();
  upload_rules();
  series_->set_forces(bound_.size() == 1 ? forces_ : nullptr);
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
  series_->set_components(members, begins);
}

template <class Executor>
void DeviceScenes<Executor>::download_series(int taken) {
  const std::vector<StepControl> control = step_->control();
  const std::vector<SeriesTally> tally = series_->tally();
  std::vector<int> begins;
  for (int place : first_places_) begins.push_back(place / key_.block);
  const auto reactions = series_->reactions(begins);
  for_each_scene([&](std::size_t s) {
    DeviceScene& scene = *bound_[s];
    if (!scene.is_due) return;
    scene.series_steps = 0;
    scene.taken = taken;
    scene.control = control[s];
    scene.tally = tally[s];
    scene.reactions = reactions[s];
  });
  // What fails alone is undone: the state that was kept before may still be asked for.
  const bool is_undone = bound_.size() == 1 && tally.front().failed != 0;
  if (!is_undone) {
    const Wanted comes = what_comes();
    series_->keep_state();
    begin_seen(comes);
    launch_following();
    series_->end_state();
    take_seen(comes);
  }
  for (DeviceScene* scene : bound_) scene->is_due = false;
}

template <class Executor>
Wanted DeviceScenes<Executor>::what_comes() const {
  // What does not go on from here is uploaded again.
  if (!may_follow()) return Wanted::kState;
  const Wanted wanted = bound_.front()->wanted;
  // What is held pulls at obstacles by where it is.
  return has_anchors_ ? std::max(wanted, Wanted::kMotion) : wanted;
}

template <class Executor>
void DeviceScenes<Executor>::begin_seen(Wanted comes) {
  const PackedSystem& packed = bound_.front()->packed;
  if (comes < Wanted::kMotion)
    series_->begin_extent(static_cast<int>(packed.order.size()), extents_);
  if (comes == Wanted::kSurface) {
    series_->begin_surface(bound_.front()->surface, packed.place, surface_);
  }
  if (comes >= Wanted::kMotion) series_->begin_motion(now_, way_);
  if (comes == Wanted::kState) series_->begin_rest(was_, way_before_);
}

template <class Executor>
void DeviceScenes<Executor>::take_seen(Wanted comes) {
  for_each_scene([&](std::size_t s) {
    DeviceScene& scene = *bound_[s];
    if (!scene.is_due) return;
    scene.brought = comes;
    if (comes < Wanted::kMotion) {
      scene.extent = extents_[0];
      for (const SeriesExtent& extent : extents_) scene.extent.add(extent);
      return;
    }
    take_back(now_, s, scene.now);
    take_back(way_, s, scene.way);
    if (comes < Wanted::kState) return;
    take_back(was_, s, scene.was);
    take_back(way_before_, s, scene.way_before);
  });
}

template <class Executor>
void DeviceScenes<Executor>::bring_state() {
  DeviceScene& scene = *bound_.front();
  begin_seen(Wanted::kState);
  series_->end_state();
  scene.is_due = true;
  take_seen(Wanted::kState);
  scene.is_due = false;
}

}  // namespace pliant
