#include "pliant/geometry/mesh_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "pliant/geometry/grid.h"
#include "pliant/geometry/primitive_shapes.h"
#include "unit/geometry/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

class MeshFile : public ::testing::Test {
 protected:
  MeshFile() {
    std::string name = (std::filesystem::temp_directory_path() / "pliant_mesh_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~MeshFile() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  std::string read(const std::string& name) const {
    std::ostringstream bytes;
    bytes << std::ifstream(path(name), std::ios::binary).rdbuf();
    return bytes.str();
  }
  void expect_unreadable(const std::string& name, const std::string& bytes) const {
    write(name, bytes);
    expect_refusal([&] { read_triangle_mesh(path(name)); }, {path(name)});
  }

  std::filesystem::path folder_;
};

TriangleMesh box() { return Box(Vector3d(1.0, 2.0, 4.0)).surface(); }

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto append = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const std::uint32_t count = mesh.triangles.cols();
  append(&count, 4);
  for (const auto t : mesh.triangles.colwise()) {
    const float zero[3] = {0, 0, 0};
    append(zero, 12);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f v = mesh.vertices.col(t[k]).cast<float>();
      append(v.data(), 12);
    }
    append(zero, 2);
  }
  return bytes;
}

// A triangle in the data URI of a node that is moved by (10, 20, 30).
const char kGltf[] = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "translation": [10, 20, 30]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
"buffers": [{"byteLength": 44, "uri":
"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 6},
{"buffer": 0, "byteOffset": 8, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5123, "count": 3, "type": "SCALAR"},
{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3",
"min": [0, 0, 0], "max": [1, 1, 0]}]})";

// A unit triangle in a node that is moved by (100, 0, 0), in centimetres.
std::string collada(const std::string& up_axis) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>)" +
         up_axis + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 100 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>100 0 0</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST_F(MeshFile, ObjComesBack) {
  TriangleMesh mesh = box();
  mesh.vertices *= 0.1;  // numbers that need all their digits
  write_obj(path("box.obj"), mesh);
  const TriangleMesh back = read_triangle_mesh(path("box.obj"));
  EXPECT_NO_THROW(validate(back, "box.obj"));
  EXPECT_EQ(back.vertices.cols(), 8);
  EXPECT_EQ(back.triangles.cols(), 12);
  EXPECT_NEAR(signed_volume(back), 0.008, 1e-9);
}

TEST_F(MeshFile, ObjHoldsTheSameDoubles) {
  GridOptions options;
  options.width = 1.0 / 3.0;
  options.height = 1e-7;
  const TriangleMesh mesh = make_grid(options);
  write_obj(path("grid.obj"), mesh);
  std::istringstream text(read("grid.obj"));
  for (int v = 0; v < 4; ++v) {
    std::string letter, x, y, z;
    text >> letter >> x >> y >> z;
    EXPECT_EQ(std::stod(x), mesh.vertices(0, v));
    EXPECT_EQ(std::stod(y), mesh.vertices(1, v));
  }
}

TEST_F(MeshFile, ObjPolygonsAreCutIntoTriangles) {
  write("l.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nvn 0 0 1\n"
        "f 1//1 2//1 3//1 4//1 5//1 6//1\n");
  const TriangleMesh mesh = read_triangle_mesh(path("l.obj"));
  EXPECT_NO_THROW(validate(mesh, "l.obj"));
  EXPECT_EQ(mesh.vertices.cols(), 6);
  EXPECT_EQ(mesh.triangles.cols(), 4);
  EXPECT_NEAR(area(mesh), 3.0, 1e-6);
}

TEST_F(MeshFile, PartsAreJoinedIntoOne) {
  write("parts.obj",
        "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 4 5 6\n");
  const TriangleMesh mesh = read_triangle_mesh(path("parts.obj"));
  EXPECT_EQ(mesh.vertices.cols(), 4);
  EXPECT_EQ(mesh.triangles.cols(), 2);
  EXPECT_EQ(edges(mesh).vertices.size(), 5u);
}

TEST_F(MeshFile, SmallObjectsKeepTheirVertices) {
  TriangleMesh mesh = box();
  mesh.vertices *= 1e-6;
  write_ply(path("small.ply"), mesh);
  EXPECT_EQ(read_triangle_mesh(path("small.ply")).vertices.cols(), 8);
}

TEST_F(MeshFile, PlyComesBack) {
  write_ply(path("box.PLY"), box(), {{"heat", Eigen::VectorXd::LinSpaced(8, 0, 1)}});
  const TriangleMesh back = read_triangle_mesh(path("box.PLY"));
  EXPECT_NO_THROW(validate(back, "box.ply"));
  EXPECT_EQ(back.vertices.cols(), 8);
  EXPECT_EQ(back.triangles.cols(), 12);
  EXPECT_NEAR(signed_volume(back), 8.0, 1e-6);
}

TEST_F(MeshFile, PlyHoldsFieldsInTheOrderOfItsHeader) {
  const TriangleMesh mesh = make_grid({});
  write_ply(path("f.ply"), mesh,
            {{"wetness", Eigen::Vector4d(1, 2, 3, 4)}, {"beta", Eigen::Vector4d(5, 6, 7, 8)}});
  const std::string bytes = read("f.ply");
  const std::size_t begin = bytes.find("end_header\n") + 11;
  EXPECT_LT(bytes.find("property float z"), bytes.find("property float beta"));
  EXPECT_LT(bytes.find("property float beta"), bytes.find("property float wetness"));
  float vertex[5];
  std::memcpy(vertex, bytes.data() + begin + 3 * sizeof(vertex), sizeof(vertex));
  EXPECT_EQ(std::vector<float>(vertex, vertex + 5), (std::vector<float>{0.5, 0.5, 0, 8, 4}));
  EXPECT_EQ(bytes.size(), begin + 4 * 20 + 2 * 13);
}

TEST_F(MeshFile, StlComesBack) {
  write("box.stl", binary_stl(box()));
  const TriangleMesh back = read_triangle_mesh(path("box.stl"));
  EXPECT_NO_THROW(validate(back, "box.stl"));
  EXPECT_EQ(back.vertices.cols(), 8);
  EXPECT_NEAR(signed_volume(back), 8.0, 1e-6);
}

TEST_F(MeshFile, AsciiStlIsRead) {
  write("a.stl",
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid s\n");
  EXPECT_NEAR(area(read_triangle_mesh(path("a.stl"))), 0.5, 1e-6);
}

TEST_F(MeshFile, GltfTransformsAreApplied) {
  write("t.gltf", kGltf);
  const TriangleMesh mesh = read_triangle_mesh(path("t.gltf"));
  ASSERT_EQ(mesh.vertices.cols(), 3);
  EXPECT_EQ(mesh.vertices.col(0), Vector3d(10, 20, 30));
  EXPECT_EQ(mesh.vertices.col(1), Vector3d(11, 20, 30));
}

TEST_F(MeshFile, ColladaUnitAndTransformsAreAppliedAndAxesKept) {
  for (const char* up_axis : {"X_UP", "Y_UP", "Z_UP"}) {
    write("t.dae", collada(up_axis));
    const TriangleMesh mesh = read_triangle_mesh(path("t.dae"));
    ASSERT_EQ(mesh.vertices.cols(), 3);
    EXPECT_LT((mesh.vertices.col(0) - Vector3d(1, 0, 0)).norm(), 1e-6) << up_axis;
    EXPECT_LT((mesh.vertices.col(2) - Vector3d(1, 1, 0)).norm(), 1e-6) << up_axis;
  }
}

TEST_F(MeshFile, MissingFilesAndFoldersAreRefused) {
  expect_refusal([&] { read_triangle_mesh(path("none.obj")); }, {"none.obj", "no such file"});
  expect_refusal([&] { read_triangle_mesh(""); }, {"no such file"});
  expect_refusal([&] { read_triangle_mesh(folder_.string()); }, {"not a file"});
}

TEST_F(MeshFile, OtherExtensionsAreRefused) {
  write("a.olb", "x");
  write("noextension", "x");
  expect_refusal([&] { read_triangle_mesh(path("a.olb")); }, {"'olb'", "allowed are obj, stl"});
  expect_refusal([&] { read_triangle_mesh(path("noextension")); }, {"allowed are obj, stl"});
}

TEST_F(MeshFile, PointsLinesAndEmptyFilesAreRefused) {
  write("lines.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\n");
  expect_refusal([&] { read_triangle_mesh(path("lines.obj")); }, {"lines.obj"});
  for (const char* name : {"e.obj", "e.stl", "e.ply", "e.gltf", "e.glb", "e.dae"}) {
    expect_unreadable(name, "");
  }
  expect_unreadable("points.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n0 0 0\n");
}

TEST_F(MeshFile, TruncatedFilesAreRefused) {
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

TEST_F(MeshFile, FacesWithoutTheirVerticesAreRefused) {
  expect_unreadable("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
}

TEST_F(MeshFile, GarbageIsRefused) {
  std::mt19937 random(1);
  for (const char* extension : {"obj", "stl", "ply", "gltf", "glb", "dae"}) {
    for (int round = 0; round < 20; ++round) {
      std::string bytes(1 + random() % 5000, '\0');
      for (char& c : bytes) c = static_cast<char>(random());
      expect_unreadable(std::string("garbage.") + extension, bytes);
    }
  }
}

TEST_F(MeshFile, BadFieldsAreRefusedAndNothingIsWritten) {
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

TEST_F(MeshFile, WritingWhereOneCannotIsRefusedAndLeavesNothing) {
  const TriangleMesh mesh = make_grid({});
  expect_refusal([&] { write_ply(path("no/folder.ply"), mesh); }, {"folder.ply", "No such file"});
  std::filesystem::create_directory(path("taken.obj"));
  expect_refusal([&] { write_obj(path("taken.obj"), mesh); }, {"taken.obj"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(MeshFile, WritingReplacesTheOldFile) {
  write("a.obj", "old");
  write_obj(path("a.obj"), make_grid({}));
  EXPECT_EQ(read("a.obj").rfind("v -0.5 -0.5 0", 0), 0u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace pliant
