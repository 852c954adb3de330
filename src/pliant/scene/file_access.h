#pragma once

#include <string>

namespace pliant {

/// Which files a scene may name: a scene from elsewhere shall not read what its user did not give
/// away with it, not even for a message to quote. Free are files below the folder of the file that
/// names them and below that of the scene, in ROS packages (a package.xml is above them), and below
/// the folders of the environment variable PLIANT_FILE_ROOTS (separated by ':'). Links count as
/// where they lead. What no file names but the caller is free: text and values that a program
/// gives.

/// While one lives, a file of a scene that this thread reads may name what lies below its folder.
class SceneFolder {
 public:
  explicit SceneFolder(const std::string& scene);
  ~SceneFolder();
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

 private:
  std::string before_;
};

/// From now on all scenes may name all files: `--allow-outside`.
void allow_files_outside();

/// Throws InputError beginning with `where` unless the file `written_in` may name `path`.
void check_file_access(const std::string& path, const std::string& written_in,
                       const std::string& where);

}  // namespace pliant
