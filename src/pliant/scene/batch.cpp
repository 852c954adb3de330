#include "pliant/scene/batch.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/core/parallel.h"
#include "pliant/math/error.h"
#include "pliant/solvers/backend.h"

namespace pliant {

template <class Use>
void Batch::for_each(const Use& use) {
  parallel_for(0, size(), 1, [&](int begin, int end) {
    for (int s = begin; s < end; ++s) use(scenes_[static_cast<std::size_t>(s)]);
  });
}

Batch::Batch(const std::string& path, const SceneOverrides& overrides,
             const std::vector<std::vector<SceneValue>>& rows) {
  const auto with_row = [&](std::size_t row) {
    SceneOverrides own = overrides;
    own.values.insert(own.values.end(), rows[row].begin(), rows[row].end());
    return own;
  };
  LoadedScene first = load_scene(path, with_row(0));
  spec_ = first.spec;
  warnings_ = first.warnings;
  scenes_.resize(rows.size());
  scenes_[0].world = std::move(first.world);
  // Which one is refused first must not depend on threads.
  std::vector<std::string> refusals(rows.size());
  parallel_for(1, size(), 1, [&](int begin, int end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      try {
        const SceneOverrides own = with_row(s);
        SceneSpec spec = read_scene(path, own.package_resolver, own.values);
        apply_overrides(own, spec);
        scenes_[s].world = build_world(spec);
      } catch (const InputError& error) {
        refusals[s] = error.what();
      }
    }
  });
  for (const std::string& refusal : refusals) {
    if (!refusal.empty()) throw InputError(refusal);
  }
  join_solvers();
}

void Batch::join_solvers() {
  try {
    solvers_ = make_cuda_batch();
  } catch (const DeviceFailure&) {
    return;  // each solver falls back, or says why it cannot
  }
  for (Scene& scene : scenes_) {
    // Several bodies of a world step one after the other.
    if (scene.world->bodies().size() > 1) continue;
    // Bodies of particles take steps in parts, and prepare anew from time to time.
    if (scene.world->bodies().front().model->system_varies()) continue;
    scene.is_joined = join_batch(*scene.world->bodies().front().solver, *solvers_);
    joined_ += scene.is_joined ? 1 : 0;
  }
  for_each([](Scene& scene) {
    if (scene.is_joined) scene.world->system_changed();
  });
}

void Batch::finish(Scene& scene) {
  if (!scene.world->finish_step()) scene.failure = scene.world->failure();
  note_warnings(scene);
}

void Batch::note_warnings(Scene& scene) {
  constexpr std::size_t kMostWarnings = 20;
  for (const Body& body : scene.world->bodies()) {
    for (const std::string& warning : body.report.warnings) {
      if (scene.warnings.size() < kMostWarnings) scene.warnings.insert(body.name + ": " + warning);
    }
  }
}

void Batch::step(int count) {
  for_each([&](Scene& scene) {
    for (int k = 0; k < count && !scene.is_joined && scene.failure.empty(); ++k) {
      scene.world->begin_step();
      finish(scene);
    }
  });
  if (joined_ == 0) return;
  for_each([](Scene& scene) { scene.is_due = scene.is_joined && scene.failure.empty(); });
  if (count >= 2) step_series(count);
  for (int k = 0; k < count && any_due(); ++k) step_joined();
}

bool Batch::any_due() const {
  return std::any_of(scenes_.begin(), scenes_.end(),
                     [](const Scene& scene) { return scene.is_due; });
}

void Batch::step_joined() {
  for_each([](Scene& scene) {
    if (scene.is_due) scene.world->begin_step();
  });
  solvers_->run();
  for_each([](Scene& scene) {
    if (scene.is_due) finish(scene);
    scene.is_due = scene.is_due && scene.failure.empty();
  });
}

// All steps or none: how many of them are one series must not depend on other scenes.
void Batch::step_series(int steps) {
  for_each([&](Scene& scene) {
    scene.is_in_series = scene.is_due && scene.world->series_limit(steps) == steps;
    if (scene.is_in_series) scene.world->begin_series(steps);
  });
  const bool any = std::any_of(scenes_.begin(), scenes_.end(),
                               [](const Scene& scene) { return scene.is_in_series; });
  if (!any) return;
  solvers_->run();
  for_each([](Scene& scene) {
    if (!scene.is_in_series) return;
    scene.is_due = scene.world->finish_series() == 0;
    if (!scene.is_due) note_warnings(scene);
  });
}

}  // namespace pliant
