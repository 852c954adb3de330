#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "pliant/scene/world_batch.h"

namespace pliant {

/// `overrides` with more values.
SceneOverrides with_values(const SceneOverrides& overrides, const std::vector<SceneValue>& values);

/// Independent copies of a scene with varied values, stepped side by side (WorldBatch).
class Batch {
 public:
  enum class Refused {
    kThrow,  ///< no batch without all of its scenes
    kKeep,   ///< others go on without them
  };
  /// A scene for each row of `rows`, which are values of the scene file at `path` beside those of
  /// `overrides`. Sets the number of threads as load_scene() does. Throws InputError, unless
  /// refused scenes are kept: of the first scene that is refused.
  Batch(const std::string& path, const SceneOverrides& overrides,
        const std::vector<std::vector<SceneValue>>& rows, Refused refused = Refused::kThrow);

  int size() const { return static_cast<int>(worlds_.size()); }
  /// Why there is no such scene; empty: there is.
  const std::string& refusal(int scene) const { return refusals_[static_cast<std::size_t>(scene)]; }
  /// Of a scene that was not refused.
  const World& world(int scene) const { return *worlds_[static_cast<std::size_t>(scene)]; }
  World& world(int scene) { return *worlds_[static_cast<std::size_t>(scene)]; }
  /// Of the first that was not refused.
  const SceneSpec& spec() const { return spec_; }
  const std::vector<std::string>& warnings() const { return warnings_; }  ///< likewise
  /// Why that scene stopped; empty while it goes on.
  const std::string& failure(int scene) const { return stepper_->failure(scene); }
  /// "BODY: warning" of all its steps, each once.
  const std::set<std::string>& step_warnings(int scene) const {
    return stepper_->step_warnings(scene);
  }
  /// `count` steps of every scene that has not stopped.
  void step(int count) { stepper_->step(count); }

 private:
  SceneSpec spec_;
  std::vector<std::string> warnings_, refusals_;
  std::unique_ptr<WorldBatch> stepper_;  // outlives the worlds
  std::vector<std::unique_ptr<World>> worlds_;
};

}  // namespace pliant
