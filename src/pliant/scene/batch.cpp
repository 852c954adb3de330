#include "pliant/scene/batch.h"

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"

namespace pliant {

SceneOverrides with_values(const SceneOverrides& overrides, const std::vector<SceneValue>& values) {
  SceneOverrides own = overrides;
  own.values.insert(own.values.end(), values.begin(), values.end());
  return own;
}

Batch::Batch(const std::string& path, const SceneOverrides& overrides,
             const std::vector<std::vector<SceneValue>>& rows, Refused refused)
    : refusals_(rows.size()), worlds_(rows.size()) {
  const auto unless_refused = [&](std::size_t row, const auto& make) {
    try {
      make();
    } catch (const InputError& error) {
      refusals_[row] = error.what();
    }
  };
  // The first that is accepted says what all have in common, and sets the threads.
  std::size_t first = 0;
  for (; first < rows.size(); ++first) {
    unless_refused(first, [&] {
      LoadedScene scene = load_scene(path, with_values(overrides, rows[first]));
      spec_ = scene.spec;
      warnings_ = scene.warnings;
      worlds_[first] = std::move(scene.world);
    });
    if (worlds_[first] != nullptr) break;
    if (refused == Refused::kThrow) throw InputError(refusals_[first]);
  }
  // Which one is refused first must not depend on threads.
  parallel_for(static_cast<int>(first) + 1, size(), 1, [&](int begin, int end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      unless_refused(s, [&] {
        const SceneOverrides own = with_values(overrides, rows[s]);
        SceneSpec spec = read_scene(path, own.package_resolver, own.values);
        apply_overrides(own, spec);
        worlds_[s] = build_world(spec);
      });
    }
  });
  for (const std::string& refusal : refusals_) {
    if (!refusal.empty() && refused == Refused::kThrow) throw InputError(refusal);
  }
  std::vector<World*> worlds;
  for (const auto& world : worlds_) worlds.push_back(world.get());
  stepper_ = std::make_unique<WorldBatch>(worlds);
}

}  // namespace pliant
