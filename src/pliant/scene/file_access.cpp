#include "pliant/scene/file_access.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "pliant/math/error.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

thread_local std::string scene_folder;
std::atomic<bool> all_are_free{false};

/// Where a path leads, links and '..' followed.
fs::path real(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return !folder.empty() &&
         std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
             folder.end();
}

/// The nearest folder with a package.xml.
bool is_in_package(const fs::path& path) {
  std::error_code ignored;
  for (fs::path folder = path.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (fs::is_regular_file(folder / "package.xml", ignored)) return true;
  }
  return false;
}

bool is_below_named_root(const fs::path& path) {
  const char* variable = std::getenv("PLIANT_FILE_ROOTS");
  std::istringstream folders(variable == nullptr ? "" : variable);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty() && is_below(path, real(folder))) return true;
  }
  return false;
}

}  // namespace

SceneFolder::SceneFolder(const std::string& scene)
    : before_(std::exchange(scene_folder, real(scene).parent_path().string())) {}

SceneFolder::~SceneFolder() { scene_folder = before_; }

void allow_files_outside() { all_are_free = true; }

void check_file_access(const std::string& path, const std::string& written_in,
                       const std::string& where) {
  std::error_code ignored;
  const bool is_the_callers = !fs::is_regular_file(written_in, ignored);
  if (all_are_free || is_the_callers) return;
  const fs::path target = real(path);
  const fs::path own = real(fs::absolute(written_in, ignored).parent_path());
  if (is_below(target, own) || is_below(target, scene_folder) || is_in_package(target) ||
      is_below_named_root(target)) {
    return;
  }
  throw InputError(fmt::format(
      "{}: '{}' lies outside of what a scene may read: the folders of the file that names it and "
      "of the scene, ROS packages, and folders of PLIANT_FILE_ROOTS; move it there, name its "
      "folder (export PLIANT_FILE_ROOTS={}), or, if you trust the scene, give `pliant` "
      "--allow-outside",
      where, path, target.parent_path().string()));
}

}  // namespace pliant
