// rviz with a camera that shows a scene:
//
//   rosrun pliant rviz_of_scene SCENE CONFIGURATION [RVIZ ARGUMENT...]
//
// writes the configuration with its camera moved to $XDG_CACHE_HOME/pliant/rviz/ and becomes rviz.
// Where that cannot be done it says why and becomes rviz with the configuration as it is.
#include <ros/console.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/repair/collider_cache.h"
#include "pliant/math/error.h"
#include "pliant/ros/markers/scene_view.h"
#include "pliant/scene/scene.h"
#include "pliant/scene/yaml/text_file.h"

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 1 << 20;

/// The path of the framed configuration. Throws InputError, and what the file system throws.
std::string frame(const std::string& scene_path, const std::string& configuration_path) {
  const pliant::LoadedScene scene = pliant::load_scene(scene_path);
  const std::string text = pliant::framed_configuration(
      pliant::read_text_file(configuration_path, kMostBytes), pliant::scene_bounds(scene));
  const std::string cache = pliant::ColliderCache().folder();
  if (cache.empty()) throw pliant::InputError("there is no cache folder: set HOME");
  const fs::path folder = fs::path(cache) / "rviz";
  fs::create_directories(folder);
  const fs::path path = folder / (fs::path(scene_path).stem().string() + ".rviz");
  pliant::write_file_atomically(path.string(), text);
  return path.string();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    ROS_FATAL("usage: rviz_of_scene SCENE CONFIGURATION [RVIZ ARGUMENT...]");
    return 2;
  }
  std::string configuration = argv[2];
  try {
    configuration = frame(argv[1], argv[2]);
  } catch (const std::exception& error) {
    ROS_WARN("rviz does not look at the scene by itself: %s", error.what());
  }
  std::vector<char*> arguments;
  std::string rviz = "rviz";
  std::string option = "-d";
  for (std::string* argument : {&rviz, &option, &configuration})
    arguments.push_back(&(*argument)[0]);
  for (int i = 3; i < argc; ++i) arguments.push_back(argv[i]);
  arguments.push_back(nullptr);
  execvp("rviz", arguments.data());
  ROS_FATAL("rviz: %s", std::strerror(errno));
  return 1;
}
