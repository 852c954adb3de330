#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/solvers/device/solver_batch.h"

namespace pliant {

/// Independent worlds that are stepped side by side: by the CPU's threads, and the iterations of
/// those whose solver has the backend `cuda` by one launch for all. What a world does depends on no
/// other one.
class WorldBatch {
 public:
  /// The worlds, of which some may be null, belong to the caller, who lets go of them before this.
  explicit WorldBatch(const std::vector<World*>& worlds);

  int size() const { return static_cast<int>(scenes_.size()); }
  /// Why that world stopped; empty while it goes on.
  const std::string& failure(int scene) const { return at(scene).failure; }
  /// "BODY: warning" of all its steps, each once.
  const std::set<std::string>& step_warnings(int scene) const { return at(scene).warnings; }
  /// Lets a world that stopped, and that the caller has reset, go on.
  void go_on(int scene) { scenes_[static_cast<std::size_t>(scene)].failure.clear(); }

  /// `count` steps of every world that has not stopped.
  void step(int count);

 private:
  struct Scene {
    World* world = nullptr;
    std::string failure;
    std::set<std::string> warnings;
    bool is_joined = false;           // its solver is one of `solvers_`
    bool is_due = false;              // of those: it takes the next step
    bool is_in_resident_run = false;  // several of them on end
  };
  const Scene& at(int scene) const { return scenes_[static_cast<std::size_t>(scene)]; }
  static void finish(Scene& scene);
  static void note_warnings(Scene& scene);
  bool any_due() const;
  void step_joined();
  /// All steps of those that can take them in one resident run; they are due no more.
  void step_resident_run(int steps);
  void join_solvers();
  template <class Use>
  void for_each(const Use& use);

  std::unique_ptr<SolverBatch> solvers_;  // null: none joined
  std::vector<Scene> scenes_;
  int joined_ = 0;
};

}  // namespace pliant
