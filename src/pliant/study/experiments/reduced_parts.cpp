#include "pliant/study/experiments/reduced_parts.h"

#include <fmt/format.h>

#include <filesystem>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::string text_of(const std::string& path) { return fs::exists(path) ? read_bytes(path) : ""; }

}  // namespace

ReducedParts::ReducedParts(const std::string& folder, const std::string& settings)
    : folder_(folder + "/parts") {
  try {
    fs::create_directories(folder);
    lock_ = FolderLock(folder);
    const std::string path = folder_ + "/settings";
    const std::string there = text_of(path);
    started_afresh_ = !there.empty() && there != settings;
    if (there.empty() && fs::exists(folder_) && !fs::is_empty(folder_)) {
      throw InputError(fmt::format(
          "'{}' is there and is not of a computation that was stopped: move it away", folder_));
    }
    if (there != settings) fs::remove_all(folder_);
    fs::create_directories(folder_);
    if (there != settings) write_file_atomically(path, settings);
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{}: cannot be used: {}", folder, error.code().message()));
  }
}

void ReducedParts::remove() const {
  fs::remove_all(folder_);
  // The folder around them goes too, unless there is more in it.
  std::error_code ignored;
  fs::remove(fs::path(folder_).parent_path(), ignored);
}

std::string ReducedParts::part(const std::string& key,
                               const std::function<std::string()>& make) const {
  const std::string path = folder_ + "/" + key;
  std::string text = text_of(path);
  if (!text.empty()) return text;
  text = make();
  if (!text.empty()) write_file_atomically(path, text);
  return text;
}

}  // namespace pliant
