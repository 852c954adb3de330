#include "pliant/geometry/io/growing_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/folder_lock.h"
#include "pliant/geometry/io/numpy_file.h"
#include "support/expect_refusal.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

class GrowingFileTest : public testing::Test {
 protected:
  /// Other ways to a file that nobody means: each leads to what is not to change.
  std::vector<std::string> traps() {
    files_.write("precious", "mine");
    fs::create_symlink(files_.path("precious"), files_.path("link"));
    fs::create_symlink(files_.path("elsewhere"), files_.path("dangling"));
    fs::create_hard_link(files_.path("precious"), files_.path("second_name"));
    EXPECT_EQ(mkfifo(files_.path("pipe").c_str(), 0600), 0);
    return {files_.path("link"), files_.path("dangling"), files_.path("second_name"),
            files_.path("pipe")};
  }
  void expect_nothing_changed() {
    EXPECT_EQ(contents(files_.path("precious")), "mine");
    EXPECT_FALSE(fs::exists(files_.path("elsewhere")));
  }
  SceneFiles files_;
};

TEST_F(GrowingFileTest, KeepsWhatIsWrittenAtOnce) {
  const std::string path = files_.path("rows");
  {
    const GrowingFile file = GrowingFile::create(path);
    file.append("one\n");
    EXPECT_EQ(contents(path), "one\n");
    file.append("two\n");
    file.write_at(0, "ONE");
    std::string bytes(100, '\0');
    EXPECT_EQ(file.read_at(4, bytes), 4u);
    EXPECT_EQ(bytes.substr(0, 4), "two\n");
  }
  const GrowingFile again = GrowingFile::open(path);
  EXPECT_EQ(again.size(), 8u);
  again.cut(4);
  again.append("three\n");
  EXPECT_EQ(contents(path), "ONE\nthree\n");
  const GrowingFile other = GrowingFile::replace(path, "new\n");
  other.append("rows\n");
  EXPECT_EQ(contents(path), "new\nrows\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(files_.path(".")), {}), 1);
}

TEST_F(GrowingFileTest, TouchesNoFileButItsOwn) {
  for (const std::string& path : traps()) {
    expect_refusal([&] { GrowingFile::create(path); }, {path, "cannot write"});
    expect_refusal([&] { GrowingFile::open(path); }, {path, "cannot write"});
    expect_nothing_changed();
    // The name is taken, and what it led to stays.
    GrowingFile::replace(path, "rows").append(" more");
    EXPECT_EQ(contents(path), "rows more");
    expect_nothing_changed();
  }
  expect_refusal([&] { GrowingFile::open(files_.path("none")); }, {"No such file"});
  expect_refusal([&] { GrowingFile::create(files_.path("no/folder")); }, {"No such file"});
}

TEST_F(GrowingFileTest, WhatIsReplacedInOneGoFollowsNoLinkEither) {
  for (const std::string& path : traps()) {
    write_file_atomically(path, "whole");
    EXPECT_EQ(contents(path), "whole");
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path)));
    expect_nothing_changed();
  }
}

TEST_F(GrowingFileTest, ArraysReplaceTheirOwnKindAlone) {
  const std::string path = files_.path("positions.npy");
  { GrowingNpy(path, {2}, 0).publish(0); }
  { GrowingNpy(path, {3}, 0).publish(0); }
  EXPECT_EQ(contents(path).substr(1, 5), "NUMPY");
  write_npy(path, {2}, {1.0, 2.0});
  const std::string mine = contents(path);
  expect_refusal([&] { GrowingNpy(path, {2}, 0); }, {path, "was not written by a batch"});
  EXPECT_EQ(contents(path), mine);
  for (const std::string& trap : traps()) {
    expect_refusal([&] { GrowingNpy(trap, {2}, 0); }, {trap, "was not written by a batch"});
  }
  expect_nothing_changed();
}

TEST_F(GrowingFileTest, AFolderIsHeldByOneAtATime) {
  const std::string folder = files_.path(".");
  {
    const FolderLock first(folder);
    expect_refusal([&] { FolderLock{folder}; }, {folder, "another one is at work there"});
  }
  FolderLock{folder};
}

}  // namespace
}  // namespace pliant
