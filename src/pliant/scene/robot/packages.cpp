#include "pliant/scene/robot/packages.h"

#include <tinyxml2.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "pliant/math/error.h"
#include "pliant/scene/file_access.h"
#include "pliant/scene/robot_library.h"

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

std::string find_in_ros_path(const std::string& package) {
  std::string folder;
  robot_function<FindRosPackage>(kFindRosPackage)(package, folder);
  return folder;
}

std::string nearest_package(const std::string& package) {
  std::vector<std::string> names;
  robot_function<NameRosPackages>(kNameRosPackages)(names);
  return nearest_name(package, names);
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
