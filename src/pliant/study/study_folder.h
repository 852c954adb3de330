#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/io/folder_lock.h"
#include "pliant/study/accuracy/accuracy_row.h"

namespace pliant {

/// Where a study keeps the rows it has measured, so that it can be stopped and go on:
///   accuracy.csv   the rows; whole at any time
///   accuracy.yaml  the settings they were measured with
/// Without a folder the rows live in memory only.
class StudyFolder {
 public:
  /// In memory.
  StudyFolder() = default;
  /// Makes the folder, or takes up the study that is in it. `settings` is the text of
  /// accuracy.yaml. Throws InputError when the folder cannot be used, belongs to another process
  /// that is at work, or holds a study with other settings; with `overwrite` that study is
  /// replaced.
  StudyFolder(std::string directory, const std::string& settings, bool overwrite);

  const std::vector<AccuracyRow>& rows() const { return rows_; }
  /// Adds a row and writes the table. Throws InputError when that fails.
  void add(const AccuracyRow& row);
  const std::string& directory() const { return directory_; }  ///< "" in memory
  std::string table_path() const { return directory_ + "/accuracy.csv"; }

  /// The text of the settings in `directory`; "" when there is no study.
  static std::string settings_in(const std::string& directory);

 private:
  void remove_study() const;
  void check_same(const std::string& there, const std::string& wanted) const;

  std::string directory_;
  FolderLock lock_;
  std::vector<AccuracyRow> rows_;
};

}  // namespace pliant
