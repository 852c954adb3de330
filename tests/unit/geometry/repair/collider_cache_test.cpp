#include "pliant/geometry/repair/collider_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/repair/collider_file.h"
#include "support/expect_refusal.h"
#include "support/meshes/broken_meshes.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

const Vector3d kAsItIs = Vector3d::Ones();

ColliderOptions coarse() {
  ColliderOptions options;
  options.voxel_size = 0.05;
  return options;
}

std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

void expect_same(const MeshCollider& a, const MeshCollider& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.shape->grid().samples, b.shape->grid().samples);
  EXPECT_EQ(a.shape->grid().origin, b.shape->grid().origin);
  EXPECT_EQ(a.shape->grid().spacing, b.shape->grid().spacing);
  EXPECT_EQ(a.shape->surface().vertices, b.shape->surface().vertices);
  EXPECT_EQ(a.shape->surface().triangles, b.shape->surface().triangles);
}

class ColliderCaching : public ::testing::Test {
 protected:
  ColliderCaching() : cache_(files_.path("cache")), mesh_(files_.path("bracket.obj")) {
    write_obj(mesh_, with_holes(fine_bracket(), 0.04, 2));
  }
  MeshCollider load() const { return load_mesh_collider(mesh_, kAsItIs, coarse(), cache_); }
  fs::path only_file() const {
    const std::vector<fs::path> files = files_in(cache_.folder());
    EXPECT_EQ(files.size(), 1u);
    return files.at(0);
  }

  SceneFiles files_;
  ColliderCache cache_;
  std::string mesh_;
};

TEST_F(ColliderCaching, GivesTheSameBitsAsMaking) {
  const MeshCollider made = load();
  const fs::path file = only_file();
  const auto written = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, written);
  const MeshCollider kept = load();
  expect_same(made, kept);
  EXPECT_EQ(made.note, kept.note);
  EXPECT_GT(fs::last_write_time(file), written) << "what is used last is removed last";
}

TEST_F(ColliderCaching, IsReadInsteadOfTheMesh) {
  load();
  // Another collider under the same key: it is what comes.
  const ColliderKey key = collider_key(
      "obj\n" +
          [&] {
            std::ifstream stream(mesh_);
            return std::string(std::istreambuf_iterator<char>(stream), {});
          }(),
      1.0, 1.0, 1.0, coarse());
  MeshCollider other = make_mesh_collider(pliant::Box(Vector3d::Ones()).surface(), coarse());
  other.note = "another one";
  std::string problem;
  cache_.write(key, other, problem);
  EXPECT_EQ(load().note, "another one");
  EXPECT_EQ(problem, "");
}

TEST_F(ColliderCaching, KeysKnowContentScaleAndOptions) {
  const ColliderKey key = collider_key("abc", 1, 1, 1, coarse());
  EXPECT_EQ(key, collider_key("abc", 1, 1, 1, coarse()));
  EXPECT_NE(key, collider_key("abd", 1, 1, 1, coarse()));
  EXPECT_NE(key, collider_key("abc", 1, 1, 2, coarse()));
  ColliderOptions options = coarse();
  options.kind = ColliderKind::kConvex;
  EXPECT_NE(key, collider_key("abc", 1, 1, 1, options));
  options = coarse();
  options.thickness = 0.1;
  EXPECT_NE(key, collider_key("abc", 1, 1, 1, options));
  options = coarse();
  options.voxel_size = 0.06;
  EXPECT_NE(key, collider_key("abc", 1, 1, 1, options));
  load();
  load_mesh_collider(mesh_, Vector3d(1, 1, 2), coarse(), cache_);
  std::ofstream(mesh_, std::ios::app) << "# another byte\n";
  load();
  EXPECT_EQ(files_in(cache_.folder()).size(), 3u);
}

TEST_F(ColliderCaching, MakesBrokenFilesAnewAndSaysSo) {
  const MeshCollider made = load();
  const fs::path file = only_file();
  std::ifstream stream(file, std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(stream), {});
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  std::string other_version = good;
  ++other_version[7];
  const std::string bad[] = {"",      "x",           good.substr(0, good.size() / 2), good + "more",
                             flipped, other_version, std::string(good.size(), '\0')};
  for (const std::string& bytes : bad) {
    std::ofstream(file, std::ios::binary) << bytes;
    const MeshCollider anew = load();
    expect_same(made, anew);
    EXPECT_NE(anew.note.find("was broken and was made anew"), std::string::npos) << anew.note;
    EXPECT_EQ(load().note, made.note) << "it is whole again";
  }
}

TEST_F(ColliderCaching, DoesWithoutAFolder) {
  const MeshCollider made = load();
  expect_same(made, load_mesh_collider(mesh_, kAsItIs, coarse(), ColliderCache("")));
  // A file stands where the folder should be.
  const ColliderCache blocked(files_.write("file", "") + "/cache");
  const MeshCollider without = load_mesh_collider(mesh_, kAsItIs, coarse(), blocked);
  expect_same(made, without);
  EXPECT_NE(without.note.find("nothing is kept in the cache"), std::string::npos) << without.note;
}

TEST_F(ColliderCaching, DoesWithAFolderThatCannotBeWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  fs::create_directories(cache_.folder());
  chmod(cache_.folder().c_str(), 0500);
  EXPECT_NE(load().note.find("nothing is kept in the cache"), std::string::npos);
  chmod(cache_.folder().c_str(), 0700);
}

TEST_F(ColliderCaching, RemovesWhatWasNotUsedTheLongest) {
  const ColliderCache small(files_.path("small"), 1'000'000);
  const MeshCollider collider = make_mesh_collider(pliant::Box(Vector3d::Ones()).surface());
  std::string problem;
  for (std::uint64_t k = 0; k < 4; ++k) {
    small.write({k, 0}, collider, problem);
    EXPECT_EQ(problem, "");
    for (const fs::path& file : files_in(small.folder())) {
      fs::last_write_time(file, fs::last_write_time(file) - std::chrono::hours(1));
    }
  }
  // Each takes 1.5 MB: the last one alone is left.
  EXPECT_EQ(files_in(small.folder()).size(), 1u);
  EXPECT_TRUE(small.read({3, 0}, problem).has_value());
  // What is not of the cache is left alone.
  std::ofstream(small.folder() + "/notes.txt") << "mine";
  small.write({9, 0}, collider, problem);
  EXPECT_TRUE(fs::exists(small.folder() + "/notes.txt"));
}

TEST(ColliderCacheFolder, IsThatOfTheXdgBaseDirectories) {
  const auto folder_with = [](const char* cache, const char* home) {
    const std::string old_cache = getenv("XDG_CACHE_HOME"), old_home = getenv("HOME");
    cache == nullptr ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", cache, 1);
    home == nullptr ? unsetenv("HOME") : setenv("HOME", home, 1);
    const std::string folder = ColliderCache().folder();
    setenv("XDG_CACHE_HOME", old_cache.c_str(), 1);
    setenv("HOME", old_home.c_str(), 1);
    return folder;
  };
  EXPECT_EQ(folder_with("/somewhere", "/home/me"), "/somewhere/pliant");
  EXPECT_EQ(folder_with(nullptr, "/home/me"), "/home/me/.cache/pliant");
  EXPECT_EQ(folder_with("not/absolute", "/home/me"), "/home/me/.cache/pliant");
  EXPECT_EQ(folder_with(nullptr, nullptr), "");
}

TEST(ColliderFile, RefusesWhatItCannotRead) {
  const SceneFiles files;
  const ColliderCache cache(files.path("cache"));
  const auto refused = [&](const std::string& path, const Vector3d& scale,
                           const std::vector<std::string>& parts) {
    expect_refusal([&] { load_mesh_collider(path, scale, {}, cache); }, parts);
  };
  refused(files.path("none.stl"), kAsItIs, {"none.stl", "no such file"});
  refused(files.write("mesh.txt", "x"), kAsItIs, {"file extension", "txt"});
  refused(files.write("a.obj", "v 0 0 0\n"), kAsItIs, {"a.obj"});
  refused(files.write("b.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), kAsItIs,
          {"mesh '", "b.obj", "none of its triangles has an area"});
  refused(files.path("b.obj"), Vector3d(1, 0, 1), {"scale"});
  EXPECT_TRUE(files_in(cache.folder()).empty());
}

TEST(ColliderFile, AMirroredMeshKeepsItsInside) {
  const SceneFiles files;
  write_obj(files.path("bracket.obj"), fine_bracket());
  const MeshCollider mirrored = load_mesh_collider(
      files.path("bracket.obj"), Vector3d(-2.0, 1.0, 1.0), coarse(), ColliderCache(""));
  EXPECT_EQ(mirrored.note, "exact");
  EXPECT_LT(mirrored.shape->distance({-1.6, 0.2, 0.2}), -0.1);
  EXPECT_GT(signed_volume(mirrored.shape->surface()), 0.0);
}

}  // namespace
}  // namespace pliant
