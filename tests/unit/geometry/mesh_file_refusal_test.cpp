#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <random>

#include "pliant/geometry/grid.h"
#include "pliant/geometry/mesh_file.h"
#include "unit/geometry/mesh_file_fixture.h"

namespace pliant {
namespace {

using MeshFileRefusal = MeshFileFixture;

TEST_F(MeshFileRefusal, MissingFilesAndFoldersAreRefused) {
  expect_refusal([&] { read_triangle_mesh(path("none.obj")); }, {"none.obj", "no such file"});
  expect_refusal([&] { read_triangle_mesh(""); }, {"no such file"});
  expect_refusal([&] { read_triangle_mesh(folder_.string()); }, {"not a file"});
}

TEST_F(MeshFileRefusal, OtherExtensionsAreRefused) {
  write("a.olb", "x");
  write("noextension", "x");
  expect_refusal([&] { read_triangle_mesh(path("a.olb")); }, {"'olb'", "allowed are obj, stl"});
  expect_refusal([&] { read_triangle_mesh(path("noextension")); }, {"allowed are obj, stl"});
}

TEST_F(MeshFileRefusal, PointsLinesAndEmptyFilesAreRefused) {
  write("lines.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\n");
  expect_refusal([&] { read_triangle_mesh(path("lines.obj")); }, {"lines.obj"});
  for (const char* name : {"e.obj", "e.stl", "e.ply", "e.gltf", "e.glb", "e.dae"}) {
    expect_unreadable(name, "");
  }
  expect_unreadable("points.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n0 0 0\n");
}

TEST_F(MeshFileRefusal, TruncatedFilesAreRefused) {
  const std::string stl = binary_stl(box());
  expect_unreadable("cut.stl", stl.substr(0, stl.size() - 60));
  write_ply(path("whole.ply"), box());
  const std::string ply = read("whole.ply");
  expect_unreadable("cut.ply", ply.substr(0, ply.size() - 20));
  expect_unreadable("cut_vertices.ply", ply.substr(0, ply.find("end_header") + 40));
  expect_unreadable("cut_header.ply", ply.substr(0, 40));
  expect_unreadable("cut.gltf", std::string(kGltf).substr(0, 300));
  expect_unreadable("cut.dae", collada("Z_UP").substr(0, 500));
}

TEST_F(MeshFileRefusal, AnyPrefixOfAFileIsReadOrRefused) {
  write_ply(path("whole.ply"), make_grid({}));
  const std::map<std::string, std::string> files = {{"cut.stl", binary_stl(make_grid({}))},
                                                    {"cut.ply", read("whole.ply")},
                                                    {"cut.gltf", kGltf},
                                                    {"cut.dae", collada("Z_UP")}};
  for (const auto& [name, bytes] : files) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      write(name, bytes.substr(0, size));
      try {
        EXPECT_GT(read_triangle_mesh(path(name)).triangles.cols(), 0);
      } catch (const InputError&) {
      }
    }
  }
}

TEST_F(MeshFileRefusal, HugeCountsInAHeaderAreRefused) {
  for (const char* count : {"4000000000", "99999999999999999999", "-1"}) {
    expect_unreadable("huge.ply", std::string("ply\nformat binary_little_endian 1.0\n") +
                                      "element vertex " + count +
                                      "\nproperty float x\nproperty float y\nproperty float z\n"
                                      "element face " +
                                      count +
                                      "\nproperty list uchar int vertex_indices\nend_header\n");
  }
  for (const char* count : {"4000000000", "99999999999999999999"}) {
    std::string gltf = kGltf;
    gltf.replace(gltf.rfind("\"count\": 3"), 10, std::string("\"count\": ") + count);
    expect_unreadable("huge.gltf", gltf);
  }
  std::string stl = binary_stl(box());
  stl.replace(80, 4, "\xFF\xFF\xFF\x7F");
  expect_unreadable("huge.stl", stl);
}

TEST_F(MeshFileRefusal, FacesWithoutTheirVerticesAreRefused) {
  expect_unreadable("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
}

TEST_F(MeshFileRefusal, GarbageIsRefused) {
  std::mt19937 random(1);
  for (const char* extension : {"obj", "stl", "ply", "gltf", "glb", "dae"}) {
    for (int round = 0; round < 20; ++round) {
      std::string bytes(1 + random() % 5000, '\0');
      for (char& c : bytes) c = static_cast<char>(random());
      expect_unreadable(std::string("garbage.") + extension, bytes);
    }
  }
}

TEST_F(MeshFileRefusal, BadFieldsAreRefusedAndNothingIsWritten) {
  const TriangleMesh mesh = make_grid({});
  const Eigen::VectorXd four = Eigen::VectorXd::Zero(4);
  for (const char* name : {"", "x", "y", "z", "two words", "line\nbreak", "\xC3\xA4"}) {
    expect_refusal([&] { write_ply(path("f.ply"), mesh, {{name, four}}); }, {"field name", "z"});
  }
  expect_refusal(
      [&] {
        write_ply(path("f.ply"), mesh, {{"heat", Eigen::VectorXd::Zero(3)}});
      },
      {"'heat' has 3 values for 4 vertices"});
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(MeshFileRefusal, WritingWhereOneCannotIsRefusedAndLeavesNothing) {
  const TriangleMesh mesh = make_grid({});
  expect_refusal([&] { write_ply(path("no/folder.ply"), mesh); }, {"folder.ply", "No such file"});
  std::filesystem::create_directory(path("taken.obj"));
  expect_refusal([&] { write_obj(path("taken.obj"), mesh); }, {"taken.obj"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace pliant
