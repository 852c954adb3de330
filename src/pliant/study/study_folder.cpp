#include "pliant/study/study_folder.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/text_file.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = 5'000'000;
constexpr const char* kTable = "accuracy.csv";
constexpr const char* kSettings = "accuracy.yaml";
constexpr const char* kPictures[] = {"accuracy.png", "accuracy.svg"};

std::string text_of(const fs::path& path) {
  return fs::exists(path) ? read_text_file(path.string(), kMaxBytes) : "";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string StudyFolder::settings_in(const std::string& directory) {
  return text_of(fs::path(directory) / kSettings);
}

StudyFolder::StudyFolder(std::string directory, const std::string& settings, bool overwrite)
    : directory_(std::move(directory)) {
  try {
    fs::create_directories(directory_);
    lock_ = FolderLock(directory_);
    if (overwrite) remove_study();  // one of that name that is no study's is refused below
    const std::string there = settings_in(directory_);
    const std::string table = text_of(table_path());
    if (there.empty() && !table.empty()) {
      throw InputError(
          fmt::format("{}: there is no {} beside it, as a study would leave: choose another "
                      "--out, or move it away",
                      table_path(), kSettings));
    }
    if (!there.empty()) check_same(there, settings);
    if (!table.empty()) rows_ = rows_from_csv(table, table_path());
    if (there.empty()) write_file_atomically(directory_ + "/" + kSettings, settings);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be used for a study: {}", directory_, error.code().message()));
  }
}

void StudyFolder::remove_study() const {
  if (settings_in(directory_).empty()) return;
  for (const char* name : {kTable, kSettings, kPictures[0], kPictures[1]}) {
    fs::remove(fs::path(directory_) / name);
  }
}

void StudyFolder::check_same(const std::string& there, const std::string& wanted) const {
  if (there == wanted) return;
  const std::vector<std::string> old_lines = lines_of(there), new_lines = lines_of(wanted);
  std::size_t k = 0;
  while (k < old_lines.size() && k < new_lines.size() && old_lines[k] == new_lines[k]) ++k;
  throw InputError(
      fmt::format("{}: a study with other settings is there ('{}', now '{}'); choose another "
                  "--out, ask for the "
                  "same settings, or replace that study with --overwrite",
                  directory_, k < old_lines.size() ? old_lines[k] : "",
                  k < new_lines.size() ? new_lines[k] : ""));
}

void StudyFolder::add(const AccuracyRow& row) {
  rows_.push_back(row);
  if (!directory_.empty()) write_file_atomically(table_path(), to_csv(rows_));
}

}  // namespace pliant
