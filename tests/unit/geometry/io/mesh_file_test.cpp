#include "pliant/geometry/io/mesh_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

#include "pliant/geometry/mesh/grid.h"
#include "unit/geometry/io/mesh_file_fixture.h"

namespace pliant {
namespace {

using MeshFile = MeshFileFixture;
using Eigen::Vector3d;

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

TEST_F(MeshFile, PlyCommentsAreSkipped) {
  write("a.ply",
        "ply\nformat ascii 1.0\ncomment one element too many\nelement vertex 3\n"
        "property float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_NEAR(area(read_triangle_mesh(path("a.ply"))), 0.5, 1e-12);
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
  // A node that mirrors turns the triangles over, so that outside stays outside.
  const auto normal = [](const TriangleMesh& of) {
    const Eigen::Vector3i t = of.triangles.col(0);
    const Vector3d a = of.vertices.col(t[0]);
    return (of.vertices.col(t[1]) - a).cross(of.vertices.col(t[2]) - a).eval();
  };
  EXPECT_GT(normal(mesh).z(), 0.5);
  std::string mirrored = kGltf;
  const std::string moved = "\"translation\": [10, 20, 30]";
  write("m.gltf", mirrored.replace(mirrored.find(moved), moved.size(), "\"scale\": [1, 1, -1]"));
  EXPECT_LT(normal(read_triangle_mesh(path("m.gltf"))).z(), -0.5);
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

TEST_F(MeshFile, WritingReplacesTheOldFile) {
  write("a.obj", "old");
  write_obj(path("a.obj"), make_grid({}));
  EXPECT_EQ(read("a.obj").rfind("v -0.5 -0.5 0", 0), 0u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace pliant
