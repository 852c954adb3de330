#pragma once

#include "cuda/solvers/resident_run/device_resident_run.h"

/// What is read back of the state where the steps of a DeviceResidentRun ended.
namespace pliant {

template <class Executor>
void DeviceResidentRun<Executor>::keep_state() {
  const int count = step_.particles();
  const auto copy = [&](auto& seen, const auto& array) {
    const auto size = static_cast<std::size_t>(count);
    if (seen.size() < size) seen.resize(size);
    step_.executor().launch(
        count, CopyNumbers<std::decay_t<decltype(*seen.data())>>{array.data(), seen.data()});
  };
  copy(seen_now_, now_);
  copy(seen_was_, was_);
  copy(seen_velocity_, velocity_);
  copy(seen_before_, before_);
}

template <class Executor>
template <class Positions, class Velocities>
void DeviceResidentRun<Executor>::begin_motion(Positions& now, Velocities& velocity) {
  now.resize(seen_now_.size());
  velocity.resize(seen_velocity_.size());
  step_.executor().begin_download(now.data(), seen_now_, now.size());
  step_.executor().begin_download(velocity.data(), seen_velocity_, velocity.size());
}

template <class Executor>
template <class Positions, class Velocities>
void DeviceResidentRun<Executor>::begin_rest(Positions& was, Velocities& before) {
  was.resize(seen_was_.size());
  before.resize(seen_before_.size());
  step_.executor().begin_download(was.data(), seen_was_, was.size());
  step_.executor().begin_download(before.data(), seen_before_, before.size());
}

template <class Executor>
template <class Points>
void DeviceResidentRun<Executor>::begin_surface(const EmbeddedPoints* surface,
                                                const std::vector<int>& place, Points& points) {
  surface_.bind(step_.executor(), surface, place);
  surface_.begin_download(step_.executor(), seen_now_.data(), points);
}

template <class Executor>
template <class Extents>
void DeviceResidentRun<Executor>::begin_extent(int particles, Extents& of_runs) {
  const int runs = (particles + FindExtent::kRun - 1) / FindExtent::kRun;
  const auto size = static_cast<std::size_t>(runs);
  if (extents_.size() < size) extents_.resize(size);
  step_.executor().launch_blocks(
      runs, FindExtent::kThreads, FindExtent::kFloats,
      FindExtent{seen_now_.data(), seen_velocity_.data(), particles, extents_.data()});
  of_runs.resize(size);
  step_.executor().begin_download(of_runs.data(), extents_, size);
}

}  // namespace pliant
