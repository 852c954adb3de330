#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "pliant/solvers/solver_batch.h"

namespace pliant {

/// Independent copies of a scene with varied values, stepped side by side: by the CPU's threads,
/// and the iterations of those whose solver has the backend `cuda` by one launch for all. What a
/// scene does depends on no other one.
class Batch {
 public:
  /// A scene for each row of `rows`, which are values of the scene file at `path` beside those of
  /// `overrides`. Sets the number of threads as load_scene() does. Throws InputError: of the first
  /// scene that is refused.
  Batch(const std::string& path, const SceneOverrides& overrides,
        const std::vector<std::vector<SceneValue>>& rows);

  int size() const { return static_cast<int>(scenes_.size()); }
  const World& world(int scene) const { return *scenes_[static_cast<std::size_t>(scene)].world; }
  const SceneSpec& spec() const { return spec_; }                         ///< of the first
  const std::vector<std::string>& warnings() const { return warnings_; }  ///< each once
  /// Why that scene stopped; empty while it goes on.
  const std::string& failure(int scene) const {
    return scenes_[static_cast<std::size_t>(scene)].failure;
  }

  /// "BODY: warning" of all its steps, each once.
  const std::set<std::string>& step_warnings(int scene) const {
    return scenes_[static_cast<std::size_t>(scene)].warnings;
  }

  /// `count` steps of every scene that has not stopped.
  void step(int count);

 private:
  struct Scene {
    std::unique_ptr<World> world;
    std::string failure;
    std::set<std::string> warnings;
    bool is_joined = false;     // its solver is one of `solvers_`
    bool is_due = false;        // of those: it takes the next step
    bool is_in_series = false;  // several of them on end
  };
  static void finish(Scene& scene);
  static void note_warnings(Scene& scene);
  bool any_due() const;
  void step_joined();
  /// All steps of those that can take them without a look in between; they are due no more.
  void step_series(int steps);
  void join_solvers();
  template <class Use>
  void for_each(const Use& use);

  SceneSpec spec_;
  std::vector<std::string> warnings_;
  std::unique_ptr<SolverBatch> solvers_;  // null: none joined; outlives them
  std::vector<Scene> scenes_;
  int joined_ = 0;
};

}  // namespace pliant
