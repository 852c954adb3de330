#include "pliant/scene/world_batch.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

template <class Use>
void WorldBatch::for_each(const Use& use) {
  parallel_for(0, size(), 1, [&](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      Scene& scene = scenes_[static_cast<std::size_t>(s)];
      if (scene.world != nullptr) use(scene);
    }
  });
}

WorldBatch::WorldBatch(const std::vector<World*>& worlds) : scenes_(worlds.size()) {
  for (std::size_t s = 0; s < worlds.size(); ++s) scenes_[s].world = worlds[s];
  join_solvers();
}

void WorldBatch::join_solvers() {
  try {
    solvers_ = make_cuda_batch();
  } catch (const DeviceFailure&) {
    return;  // each solver falls back, or says why it cannot
  }
  for (Scene& scene : scenes_) {
    // Several bodies of a world step one after the other.
    if (scene.world == nullptr || scene.world->bodies().size() > 1) continue;
    // Bodies of particles take steps in substeps, and prepare anew from time to time.
    if (scene.world->bodies().front().model->system_varies()) continue;
    // A step that is taken again is no step of the others.
    if (scene.world->yields()) continue;
    scene.is_joined = scene.world->bodies().front().solver->join(*solvers_);
    joined_ += scene.is_joined ? 1 : 0;
  }
  for_each([](Scene& scene) {
    if (scene.is_joined) scene.world->system_changed();
  });
}

void WorldBatch::finish(Scene& scene) {
  if (!scene.world->finish_step()) scene.failure = scene.world->failure();
  note_warnings(scene);
}

void WorldBatch::note_warnings(Scene& scene) {
  constexpr std::size_t kMostWarnings = 20;
  for (const Body& body : scene.world->bodies()) {
    for (const std::string& warning : body.report.warnings) {
      if (scene.warnings.size() < kMostWarnings) scene.warnings.insert(body.name + ": " + warning);
    }
  }
}

void WorldBatch::step(int count) {
  for_each([&](Scene& scene) {
    for (int k = 0; k < count && !scene.is_joined && scene.failure.empty(); ++k) {
      scene.world->begin_step();
      finish(scene);
    }
  });
  if (joined_ == 0) return;
  for_each([](Scene& scene) { scene.is_due = scene.is_joined && scene.failure.empty(); });
  if (count >= 2) step_resident_run(count);
  for (int k = 0; k < count && any_due(); ++k) step_joined();
}

bool WorldBatch::any_due() const {
  return std::any_of(scenes_.begin(), scenes_.end(),
                     [](const Scene& scene) { return scene.is_due; });
}

void WorldBatch::step_joined() {
  for_each([](Scene& scene) {
    if (scene.is_due) scene.world->begin_step();
  });
  solvers_->run();
  for_each([](Scene& scene) {
    if (scene.is_due) finish(scene);
    scene.is_due = scene.is_due && scene.failure.empty();
  });
}

// All steps or none: how many of them are one resident run must not depend on other scenes.
void WorldBatch::step_resident_run(int steps) {
  for_each([&](Scene& scene) {
    scene.is_in_resident_run = scene.is_due && scene.world->resident_limit(steps) == steps;
    if (scene.is_in_resident_run) scene.world->begin_resident_run(steps);
  });
  const bool any = std::any_of(scenes_.begin(), scenes_.end(),
                               [](const Scene& scene) { return scene.is_in_resident_run; });
  if (!any) return;
  solvers_->run();
  for_each([](Scene& scene) {
    if (!scene.is_in_resident_run) return;
    scene.is_due = scene.world->finish_resident_run() == 0;
    if (!scene.is_due) note_warnings(scene);
  });
}

}  // namespace pliant
