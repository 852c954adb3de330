#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pliant/geometry/io/folder_lock.h"
#include "pliant/geometry/io/growing_file.h"

namespace pliant {

/// Where a batch writes, so that it can be stopped at any time and go on:
///   tables         rows of the scenes that are finished; the first one is scenes.csv
///   batch.yaml     what they were made of, and how many there are
///   unfinished.state  what is known of those that are not finished (batch_checkpoint.h)
/// Tables hold whole scenes only, the same ones; what a crash left beyond these is cut off.
class BatchFolder {
 public:
  enum class Start { kNew, kOverwrite, kResume };

  struct Table {
    std::string name;    ///< of the file
    std::string header;  ///< its first line
  };
  /// What scenes are made of, as a hash; and which ones are asked for.
  struct Inputs {
    std::string hash;
    std::size_t begin = 0, end = 0;
  };
  /// Makes the folder, or takes up what is in it. Throws InputError: it cannot be used, another
  /// process works in it, it has scenes already (kNew), or those of other inputs (kResume).
  BatchFolder(std::string folder, const Inputs& inputs, std::vector<Table> tables, Start start);

  const std::string& path() const { return folder_; }
  std::size_t finished() const { return finished_; }  ///< scenes
  /// Appends their rows, to each table its own.
  void add(const std::vector<std::string>& rows);
  /// That many are finished now; what else belongs to them is on the disk.
  void publish(std::size_t finished);

  /// What was kept of scenes that are not finished, of the same inputs; "": nothing.
  std::string unfinished() const;
  void keep_unfinished(const std::string& bytes) const;
  std::string state() const { return folder_ + "/unfinished.state"; }  ///< the file

 private:
  std::string path_of(const Table& table) const { return folder_ + "/" + table.name; }
  std::string scenes() const { return path_of(tables_.front()); }
  std::string notes() const { return folder_ + "/batch.yaml"; }
  void take_up();
  void begin();

  std::string folder_;
  Inputs inputs_;
  FolderLock lock_;
  std::size_t finished_ = 0;
  std::vector<Table> tables_;
  std::vector<GrowingFile> rows_;  // of each table
};

}  // namespace pliant
