#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "pliant/study/generated/generated_oracles.h"

namespace pliant {

/// Tries a scene in a process of its own, so that one that dies or hangs is an outcome too. Only
/// where nothing has started threads yet.
class SceneChild {
 public:
  /// A child that uses more of the processor is ended [s].
  static constexpr int kMostSeconds = 240;

  /// Throws std::runtime_error where the system gives no process.
  SceneChild(int index, const SceneChoice& choice, const std::string& robot);
  /// Ends it, if it runs.
  ~SceneChild();
  SceneChild(const SceneChild&) = delete;
  SceneChild& operator=(const SceneChild&) = delete;

  int index() const { return index_; }            ///< as it was given
  int descriptor() const { return descriptor_; }  ///< to wait for, until it can be read
  /// Call it when there is something to read: the outcome once the child has ended.
  std::optional<SceneOutcome> read();

 private:
  int index_;
  pid_t process_ = -1;
  int descriptor_ = -1;
  std::string text_;
};

}  // namespace pliant
