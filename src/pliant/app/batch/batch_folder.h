#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pliant/geometry/io/folder_lock.h"
#include "pliant/geometry/io/growing_file.h"

namespace pliant {

/// Where a batch writes, so that it can be stopped at any time and go on:
///   scenes.csv    rows of the scenes that are finished
///   batch.yaml    what they were made of, and how many there are
/// Files hold whole scenes only, the same ones; what a crash left beyond these is cut off.
class BatchFolder {
 public:
  enum class Start { kNew, kOverwrite, kResume };

  /// What scenes are made of, as a hash; and which ones are asked for.
  struct Inputs {
    std::string hash;
    std::size_t begin = 0, end = 0;
  };
  /// Makes the folder, or takes up what is in it. Throws InputError: it cannot be used, another
  /// process works in it, it has scenes already (kNew), or those of other inputs (kResume).
  BatchFolder(std::string folder, const Inputs& inputs, const std::string& header, Start start);

  const std::string& path() const { return folder_; }
  std::size_t finished() const { return finished_; }  ///< scenes
  /// Appends their rows.
  void add(const std::string& rows);
  /// That many are finished now; what else belongs to them is on the disk.
  void publish(std::size_t finished);

 private:
  std::string table() const { return folder_ + "/scenes.csv"; }
  std::string notes() const { return folder_ + "/batch.yaml"; }
  void take_up();
  void begin(const std::string& header);

  std::string folder_;
  Inputs inputs_;
  FolderLock lock_;
  std::size_t finished_ = 0;
  std::optional<GrowingFile> rows_;  // scenes.csv
};

}  // namespace pliant
