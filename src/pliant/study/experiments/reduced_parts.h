#pragma once

#include <functional>
#include <string>

#include "pliant/geometry/io/folder_lock.h"

namespace pliant {

/// The finished parts of a long computation, each in a file of its own, so that one that was
/// stopped goes on after the last of them:
///   FOLDER/parts/settings   the options that all parts were made with
///   FOLDER/parts/KEY        rows of a table, or numbers
class ReducedParts {
 public:
  /// Takes up the parts in `folder`, which it makes where there is none; those of other settings
  /// are removed. Throws InputError when the folder cannot be used, holds a folder `parts` of
  /// something else, or another process is at work there.
  ReducedParts(const std::string& folder, const std::string& settings);

  /// Whether parts of other settings were there.
  bool started_afresh() const { return started_afresh_; }
  /// Removes all parts, and their folder where nothing else is in it.
  void remove() const;
  /// The part's bytes: the one that is there, or what `make` returns, which is kept; "" when `make`
  /// was asked to stop, and nothing is kept. Keys are letters, digits, '_', '-' and '.'.
  std::string part(const std::string& key, const std::function<std::string()>& make) const;

 private:
  std::string folder_;
  FolderLock lock_;
  bool started_afresh_ = false;
};

}  // namespace pliant
