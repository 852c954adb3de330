#include "pliant/scene/robot/packages.h"

#include <tinyxml2.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <set>
#include <sstream>
#include <utility>
#include <vector>
#ifdef PLIANT_ROSPACK
#include <rospack/rospack.h>
#endif

#include "pliant/math/error.h"
#include "pliant/scene/file_access.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// Whether `folder` has a package.xml of that name.
bool is_package(const fs::path& folder, const std::string& package) {
  tinyxml2::XMLDocument manifest;
  if (manifest.LoadFile((folder / "package.xml").c_str()) != tinyxml2::XML_SUCCESS) return false;
  const tinyxml2::XMLElement* root = manifest.FirstChildElement("package");
  const tinyxml2::XMLElement* name = root == nullptr ? nullptr : root->FirstChildElement("name");
  return name != nullptr && name->GetText() != nullptr && package == name->GetText();
}

#ifdef PLIANT_ROSPACK

/// ROS's own index of packages, which crawls workspaces of any depth and knows which of two
/// packages of one name hides the other. All that is asked within a second shares a crawl, such as
/// the meshes of a robot.
class PackageIndex {
 public:
  PackageIndex() { index_.setQuiet(true); }

  /// The folder of a package; "" without.
  std::string find(const std::string& package) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool is_new = crawl(kShared);
    std::string folder;
    if (index_.find(package, folder)) return folder;
    if (is_new) return "";
    crawl(Clock::duration::zero());
    return index_.find(package, folder) ? folder : "";
  }

  std::vector<std::string> names() {
    const std::lock_guard<std::mutex> lock(mutex_);
    crawl(kShared);
    std::set<std::pair<std::string, std::string>> found;
    index_.list(found);
    std::vector<std::string> names;
    for (const auto& [name, folder] : found) names.push_back(name);
    return names;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kShared = std::chrono::seconds(1);

  /// Crawls unless the last time is not longer ago than `age`; whether it did.
  bool crawl(Clock::duration age) {
    std::vector<std::string> path;
    index_.getSearchPathFromEnv(path);
    const Clock::time_point now = Clock::now();
    if (path == path_ && now - crawled_at_ < age) return false;
    index_.crawl(path, true);
    path_ = path;
    crawled_at_ = now;
    return true;
  }

  std::mutex mutex_;  // rospack writes a cache
  rospack::Rospack index_;
  std::vector<std::string> path_;
  Clock::time_point crawled_at_;
};

PackageIndex& package_index() {
  static PackageIndex index;
  return index;
}

std::string find_in_ros_path(const std::string& package) { return package_index().find(package); }

std::string nearest_package(const std::string& package) {
  return nearest_name(package, package_index().names());
}

#else

std::string find_in_ros_path(const std::string& package) {
  const char* variable = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream folders(variable == nullptr ? "" : variable);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (folder.empty()) continue;
    for (const fs::path& candidate : {fs::path(folder), fs::path(folder) / package}) {
      if (is_package(candidate, package)) return candidate.string();
    }
  }
  return "";
}

std::string nearest_package(const std::string&) { return ""; }

#endif

bool starts_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

std::string resolve_in_package(const std::string& rest, const std::string& written_in,
                               const PackageResolver& resolver, const std::string& where) {
  const auto slash = rest.find('/');
  const std::string package = rest.substr(0, slash);
  if (package.empty() || slash == std::string::npos || slash + 1 == rest.size()) {
    throw InputError(where + ": 'package://" + rest + "' must be package://NAME/FILE");
  }
  const std::string folder = resolver ? resolver(package) : find_package(package, written_in);
  if (folder.empty()) {
    const std::string nearest = nearest_package(package);
    throw InputError(where + ": package '" + package + "' of 'package://" + rest +
                     "' is neither on ROS_PACKAGE_PATH nor above the file; " +
                     (nearest.empty() ? "source the setup.bash of its workspace"
                                      : "did you mean '" + nearest + "'?"));
  }
  return (fs::path(folder) / rest.substr(slash + 1)).lexically_normal().string();
}

}  // namespace

std::string find_package(const std::string& package, const std::string& near_file) {
  const std::string found = find_in_ros_path(package);
  if (!found.empty() || near_file.empty()) return found;
  std::error_code ignored;
  fs::path folder = fs::absolute(near_file, ignored).parent_path();
  while (!is_package(folder, package)) {
    if (!folder.has_relative_path()) return "";
    folder = folder.parent_path();
  }
  return folder.string();
}

namespace {

std::string without_check(const std::string& text, const std::string& written_in,
                          const PackageResolver& resolver, const std::string& where) {
  if (text.empty()) throw InputError(where + ": the path is empty");
  if (starts_with(text, "package://")) {
    return resolve_in_package(text.substr(10), written_in, resolver, where);
  }
  if (starts_with(text, "file://")) return text.substr(7);
  if (text.find("://") != std::string::npos) {
    throw InputError(where + ": '" + text +
                     "' must be a path, package://NAME/FILE or file:///PATH");
  }
  if (fs::path(text).is_absolute()) return text;
  if (written_in.empty()) {
    throw InputError(where + ": '" + text +
                     "' is relative, but there is no file to be relative to;" +
                     " use package://NAME/FILE or an absolute path");
  }
  std::error_code ignored;
  const fs::path folder = fs::absolute(written_in, ignored).parent_path();
  return (folder / text).lexically_normal().string();
}

}  // namespace

std::string resolve_path(const std::string& text, const std::string& written_in,
                         const PackageResolver& resolver, const std::string& where) {
  std::string path = without_check(text, written_in, resolver, where);
  check_file_access(path, written_in, where);
  return path;
}

}  // namespace pliant
