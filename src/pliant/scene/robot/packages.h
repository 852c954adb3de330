#pragma once

#include <functional>
#include <string>

namespace pliant {

/// Gives the folder of a ROS package, or "" when there is none of that name.
using PackageResolver = std::function<std::string(const std::string& package)>;

/// Looks for a package of that name as `rospack find` does, then for its package.xml in the folders
/// above `near_file`. Where the library was built without rospack, it looks in the folders of
/// ROS_PACKAGE_PATH, each a package or a folder of packages. "" when not found.
std::string find_package(const std::string& package, const std::string& near_file);

/// The absolute path that `text` means when it is written in `written_in`: "package://NAME/REST",
/// "file:///PATH", an absolute path, or one relative to the folder of `written_in`; the last is
/// refused when `written_in` is empty. `resolver` may be null: then find_package() is used.
/// Throws InputError beginning with `where`, also for a file that `written_in` may not name
/// (file_access.h).
std::string resolve_path(const std::string& text, const std::string& written_in,
                         const PackageResolver& resolver, const std::string& where);

}  // namespace pliant
