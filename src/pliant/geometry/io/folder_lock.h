#pragma once

#include <memory>
#include <string>

namespace pliant {

/// Holds a folder for this process, until it is gone or the process is, also by a crash: the
/// system's lock on the folder, so that none can be left behind.
class FolderLock {
 public:
  FolderLock() = default;
  /// Throws InputError when `folder` cannot be opened or a process holds it, with that process's
  /// number where the system tells it.
  explicit FolderLock(const std::string& folder);

 private:
  std::shared_ptr<const int> descriptor_;
};

}  // namespace pliant
