#include "pliant/scene/robot/packages.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "pliant/scene/file_access.h"
#include "pliant/scene/robot_library.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr const char* kPackage = "<package>\n  <name>soft_things</name>\n</package>\n";

class RosPath {
 public:
  explicit RosPath(const std::string& value) {
    if (const char* old = std::getenv("ROS_PACKAGE_PATH")) old_ = old;
    if (const char* old = std::getenv("ROS_HOME")) old_home_ = old;
    setenv("ROS_PACKAGE_PATH", value.c_str(), 1);
    // rospack writes what it found there.
    setenv("ROS_HOME", home_.path("").c_str(), 1);
  }
  ~RosPath() {
    setenv("ROS_PACKAGE_PATH", old_.c_str(), 1);
    old_home_.empty() ? unsetenv("ROS_HOME") : setenv("ROS_HOME", old_home_.c_str(), 1);
  }

 private:
  SceneFiles home_;
  std::string old_home_;
  std::string old_;
};

TEST(FindPackage, WalksUpFromTheFile) {
  const SceneFiles files;
  files.write("package.xml", kPackage);
  const std::string scene = files.write("config/scenes/s.yaml", "");
  const RosPath none("");
  EXPECT_EQ(find_package("soft_things", scene) + "/", files.path(""));
  EXPECT_EQ(find_package("hard_things", scene), "");
  EXPECT_EQ(find_package("soft_things", ""), "");
}

TEST(FindPackage, LooksOnTheRosPath) {
  const SceneFiles files;
  files.write("src/soft_things/package.xml", kPackage);
  const RosPath path("/nowhere:" + files.path("src"));
  EXPECT_EQ(find_package("soft_things", ""), files.path("src/soft_things"));
  const RosPath itself(files.path("src/soft_things"));
  EXPECT_EQ(find_package("soft_things", ""), files.path("src/soft_things"));
}

#ifdef PLIANT_ROSPACK

// Repositories of several packages, as workspaces have them; the first workspace hides the others.
TEST(FindPackage, LooksIntoRepositoriesAndRespectsOverlays) {
  const SceneFiles files;
  files.write("over/repository/soft_things/package.xml", kPackage);
  files.write("under/soft_things/package.xml", kPackage);
  const RosPath path(files.path("over") + ":" + files.path("under"));
  EXPECT_EQ(find_package("soft_things", ""), files.path("over/repository/soft_things"));
  expect_refusal([&] { resolve_path("package://sof_things/a.stl", "", nullptr, "W"); },
                 {"package 'sof_things'", "did you mean 'soft_things'?"});
}

#endif

TEST(ResolvePath, KnowsEveryForm) {
  const PackageResolver resolver = [](const std::string& package) {
    return package == "p" ? std::string("/share/p") : std::string();
  };
  EXPECT_EQ(resolve_path("package://p/m/a.stl", "", resolver, "w"), "/share/p/m/a.stl");
  EXPECT_EQ(resolve_path("file:///m/a.stl", "", resolver, "w"), "/m/a.stl");
  EXPECT_EQ(resolve_path("/m/a.stl", "/x/s.yaml", resolver, "w"), "/m/a.stl");
  EXPECT_EQ(resolve_path("../m/a.stl", "/x/y/s.yaml", resolver, "w"), "/x/m/a.stl");
}

TEST(ResolvePath, RefusesWhatItCannotResolve) {
  const PackageResolver none = [](const std::string&) { return std::string(); };
  expect_refusal([&] { resolve_path("package://q/a", "", none, "W"); }, {"W: ", "'q'"});
  expect_refusal([&] { resolve_path("package://q", "", none, "W"); }, {"package://NAME/FILE"});
  expect_refusal([&] { resolve_path("package:///a", "", none, "W"); }, {"package://NAME/FILE"});
  expect_refusal([&] { resolve_path("http://a/b", "/x", none, "W"); }, {"http://a/b"});
  expect_refusal([&] { resolve_path("a.stl", "", none, "W"); }, {"relative"});
  expect_refusal([&] { resolve_path("", "/x", none, "W"); }, {"empty"});
}

// A scene from elsewhere that names a file of its reader's.
TEST(ResolvePath, StaysInTheFoldersOfTheScenePackagesAndNamedRoots) {
  const SceneFiles files, other, package;
  const std::string scene = files.write("scenes/s.yaml", ""),
                    part = files.write("scenes/a/p.yaml", "");
  files.write("scenes/a/mesh.obj", "");
  const std::string secret = other.write("secret.yaml", "");
  package.write("package.xml", kPackage);
  const std::string shared = package.write("meshes/m.obj", "");
  std::filesystem::create_symlink(secret, files.path("scenes/a/link.yaml"));
  std::filesystem::create_symlink(shared, files.path("scenes/a/shared.obj"));
  const PackageResolver resolver = [&](const std::string&) { return package.path(""); };
  const auto resolve = [&](const std::string& text, const std::string& from) {
    return resolve_path(text, from, resolver, "W:1: mesh");
  };
  for (const std::string text : {"a/mesh.obj", "a/../a/mesh.obj", "a/shared.obj", "a/new.obj"}) {
    EXPECT_NO_THROW(resolve(text, scene)) << text;
  }
  for (const std::string& text : {shared, "file://" + shared, std::string("package://p/x")}) {
    EXPECT_NO_THROW(resolve(text, scene)) << text;
  }
  const std::vector<std::string> outside = {
      secret,
      "file://" + secret,
      "/etc/passwd",
      "../../../../../../etc/passwd",
      "a/link.yaml",
      "package://p/../" +
          std::filesystem::path(other.path("secret.yaml"))
              .lexically_relative(
                  std::filesystem::path(package.path("")).parent_path().parent_path())
              .string(),
      "../mesh.obj",
      files.path("scenes_too/a.obj")};
  for (const std::string& text : outside) {
    expect_refusal([&] { resolve(text, scene); },
                   {"W:1: mesh: '", "outside", "PLIANT_FILE_ROOTS=", "--allow-outside"});
  }
  // What the scene includes may name what lies beside the scene, while that is read.
  expect_refusal([&] { resolve("../s.yaml", part); }, {"outside"});
  {
    const SceneFolder reading(scene);
    EXPECT_NO_THROW(resolve("../s.yaml", part));
    expect_refusal([&] { resolve(secret, part); }, {"outside"});
  }
  expect_refusal([&] { resolve("../s.yaml", part); }, {"outside"});
  // The caller's own text and values.
  EXPECT_NO_THROW(resolve(secret, ""));
  EXPECT_NO_THROW(resolve(secret, "values"));
  setenv("PLIANT_FILE_ROOTS", ("/nowhere::" + other.path("")).c_str(), 1);
  EXPECT_NO_THROW(resolve(secret, scene));
  EXPECT_NO_THROW(resolve("a/link.yaml", scene));
  expect_refusal([&] { resolve("/etc/passwd", scene); }, {"outside"});
  unsetenv("PLIANT_FILE_ROOTS");
}

TEST(RobotLibrary, SaysWhatToDoWhereItIsNotFound) {
  LoadedLibrary none("libpliant_elsewhere.so");
  expect_refusal([&] { robot_function<MakeRobotTree>(kMakeRobotTree, none); },
                 {"robots and packages", "libpliant_elsewhere.so", "beside libpliant_core.so"});
  LoadedLibrary other("libm.so.6");  // which knows no robots
  expect_refusal([&] { robot_function<MakeRobotTree>(kMakeRobotTree, other); }, {kMakeRobotTree});
  EXPECT_NE(&robot_function<MakeRobotTree>(kMakeRobotTree), nullptr);
}

}  // namespace
}  // namespace pliant
