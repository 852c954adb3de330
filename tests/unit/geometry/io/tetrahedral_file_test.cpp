#include "pliant/geometry/io/tetrahedral_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "pliant/geometry/meshing/stuffing.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"
#include "unit/geometry/io/mesh_file_fixture.h"

namespace pliant {
namespace {

// Two tetrahedra (the second wound wrongly) on vertices 10 to 14, a vertex 99 in none, a point and
// a triangle.
const char kGmsh22[] = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 "body"
$EndPhysicalNames
$Nodes
6
10 0 0 0
11 1 0 0
12 0 1 0
99 7 7 7
13 0 0 1
14 1 1 1
$EndNodes
$Elements
4
1 15 2 0 1 10
2 2 2 0 1 10 11 12
3 4 2 1 1 10 11 12 13
4 4 3 1 1 0 11 12 14 13
$EndElements
)";

const char kGmsh41[] = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
2 6 10 99
2 1 0 3
10
11
12
0 0 0
1 0 0
0 1 0
3 1 1 3
99
13
14
7 7 7 0 0 0
0 0 1 0 0 0
1 1 1 0 0 0
$EndNodes
$Elements
2 3 1 3
2 1 2 1
1 10 11 12
3 1 4 2
2 10 11 12 13
3 11 12 14 13
$EndElements
)";

const char kNode[] = R"(# made by hand
6 3 1 1
1 0 0 0  0.5 1
2 1 0 0  0.5 1   # a comment
3 0 1 0  0.5 1
6 7 7 7  0.5 0
4 0 0 1  0.5 1
5 1 1 1  0.5 1
)";

const char kEle[] = "2 4 1\n1 1 2 3 4 7\n2 2 3 5 4 7\n# the end\n";

template <typename Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof(number)];
  std::memcpy(raw, &number, sizeof(number));
  bytes.append(raw, sizeof(number));
}

/// The numbers of kGmsh22 in a binary file.
std::string binary_22() {
  std::string bytes = "$MeshFormat\n2.2 1 8\n";
  append<std::int32_t>(bytes, 1);
  bytes += "\n$EndMeshFormat\n$Nodes\n5\n";
  const double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  for (int v = 0; v < 5; ++v) {
    append<std::int32_t>(bytes, 10 + v);
    for (const double c : x[v]) append(bytes, c);
  }
  bytes += "\n$EndNodes\n$Elements\n3\n";
  for (const std::int32_t i : {2, 1, 2, 1, 0, 1, 10, 11, 12}) append(bytes, i);
  for (const std::int32_t i : {4, 2, 2, 2, 0, 1, 10, 11, 12, 13, 3, 0, 1, 11, 12, 14, 13}) {
    append(bytes, i);
  }
  return bytes + "\n$EndElements\n";
}

std::string binary_41() {
  std::string bytes = "$MeshFormat\n4.1 1 8\n";
  append<std::int32_t>(bytes, 1);
  bytes += "\n$EndMeshFormat\n$Nodes\n";
  for (const std::int64_t i : {1, 5, 10, 14}) append(bytes, i);
  for (const std::int32_t i : {3, 1, 0}) append(bytes, i);
  append<std::int64_t>(bytes, 5);
  for (std::int64_t v = 10; v < 15; ++v) append(bytes, v);
  const double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  for (const auto& v : x) {
    for (const double c : v) append(bytes, c);
  }
  bytes += "\n$EndNodes\n$Elements\n";
  for (const std::int64_t i : {1, 2, 1, 2}) append(bytes, i);
  for (const std::int32_t i : {3, 1, 4}) append(bytes, i);
  for (const std::int64_t i : {2, 1, 10, 11, 12, 13, 2, 11, 12, 14, 13}) append(bytes, i);
  return bytes + "\n$EndElements\n";
}

class TetrahedralFile : public MeshFileFixture {
 protected:
  void expect_pair(const std::string& file) const {
    const TetrahedralMesh mesh = read_tetrahedral_mesh(file);
    ASSERT_EQ(mesh.vertices.cols(), 5) << file;
    ASSERT_EQ(mesh.tetrahedra.cols(), 2) << file;
    EXPECT_EQ(mesh.vertices.col(3), Eigen::Vector3d(0, 0, 1)) << file;
    EXPECT_EQ(mesh.vertices.col(4), Eigen::Vector3d(1, 1, 1)) << file;
    EXPECT_EQ(mesh.tetrahedra.col(0), Eigen::Vector4i(0, 1, 2, 3)) << file;
    const Eigen::VectorXd each = volumes(mesh);
    EXPECT_NEAR(each[0], 1.0 / 6.0, 1e-16) << file;
    EXPECT_NEAR(each[1], 1.0 / 3.0, 1e-16) << file;
  }
  void expect_refused(const std::string& name, const std::string& bytes,
                      std::vector<std::string> parts) const {
    write(name, bytes);
    parts.push_back(name);
    expect_refusal([&] { read_tetrahedral_mesh(path(name)); }, parts);
  }
  static std::string with(std::string text, const std::string& old, const std::string& other) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), other);
  }
};

TEST_F(TetrahedralFile, ReadsGmsh) {
  expect_pair(write("a22.msh", kGmsh22));
  expect_pair(write("a41.MSH", kGmsh41));
  expect_pair(write("b22.msh", binary_22()));
  expect_pair(write("b41.msh", binary_41()));
}

TEST_F(TetrahedralFile, ReadsTetGenByEitherName) {
  write("body.node", kNode);
  write("body.ele", kEle);
  expect_pair(path("body.ele"));
  expect_pair(path("body.node"));
}

TEST_F(TetrahedralFile, WhatIsWrittenIsReadBackBitForBit) {
  TetrahedralMesh mesh = stuff(icosphere(2), {0.4, 1000, -1.0});
  mesh.vertices.colwise() += Eigen::Vector3d(0.1, 1e-7, 1e5);
  write_msh(path("ball.msh"), mesh);
  const TetrahedralMesh back = read_tetrahedral_mesh(path("ball.msh"));
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.tetrahedra, mesh.tetrahedra);
}

TEST_F(TetrahedralFile, RefusalsSayWhatAndWhere) {
  expect_refusal([&] { read_tetrahedral_mesh(path("none.msh")); }, {"none.msh", "no such file"});
  expect_refused("a.mesh", "", {"unknown file extension 'mesh'", "did you mean 'msh'"});
  expect_refused("a.msh", "", {"line 2", "begins with $MeshFormat"});
  expect_refused("big.msh", with(binary_22(), std::string("\1\0\0\0", 4), {"\0\0\0\1", 4}),
                 {"big-endian", "write it as text"});
  expect_refused("b.msh", with(kGmsh22, "2.2 0 8", "4.0 0 8"), {"line 2", "4", "2.2 and 4.1"});
  expect_refused("c.msh", with(kGmsh22, "2.2 0 8", "2.2 0 4"), {"data size 4"});
  expect_refused("d.msh", with(kGmsh22, "12 0 1 0\n", "12 0 one 0\n"), {"line 12", "'one'"});
  expect_refused("e.msh", with(kGmsh22, "11 12 13\n", "11 12 77\n"),
                 {"line 21", "tetrahedron 3 names vertex 77"});
  expect_refused("f.msh", with(kGmsh22, "99 7 7 7", "12 7 7 7"), {"line 13", "vertex 12", "twice"});
  expect_refused("g.msh", with(kGmsh22, "1 1 1\n", "nan 1 1\n"), {"vertex 14 is not finite"});
  expect_refused("h.msh", with(kGmsh22, "\n6\n", "\n60000000000\n"), {"number of nodes"});
  expect_refused("i.msh", with(kGmsh22, "2 2 2 0 1 10 11 12\n", "2 7 2 0 1 10 11 12 13 14\n"),
                 {"element 2 is a pyramid (type 7)", "line 20"});
  expect_refused("j.msh", with(kGmsh41, "3 1 4 2", "3 1 400 2"), {"element type 400"});
  expect_refused("k.msh", with(kGmsh22, "$EndElements", ""), {"ends before '$EndElements'"});
  expect_refused("l.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", {"no $Elements"});
  expect_refused("m.msh", with(kGmsh22, "$Nodes", "Nodes"), {"'Nodes' should be the name"});
  write("lonely.node", kNode);
  expect_refusal([&] { read_tetrahedral_mesh(path("lonely.node")); }, {"lonely.ele", "no such"});
  write("bad.node", kNode);
  expect_refused("bad.ele", "2 5 0\n", {"line 1", "5 vertices a tetrahedron"});
  expect_refused("bad.ele", "2 4 0\n1 1 2 3 4\n2 2 3 5 8\n", {"line 3", "names vertex 8"});
  expect_refused("bad.ele", "3 4 0\n1 1 2 3 4\n2 2 3 4 5\n", {"file ends"});
  write("bad.ele", kEle);
  expect_refused("bad.node", "6 2 0 0\n", {"dimension 2"});
}

TEST_F(TetrahedralFile, ShapesThatCannotBeMendedAreRefusedByNumber) {
  expect_refused("flat.msh", with(kGmsh22, "14 1 1 1", "14 1 -1 1"),
                 {"1 tetrahedra are flat", ": 1"});
  expect_refused("same.msh", with(kGmsh22, "11 12 14 13", "11 10 12 13"), {"repeat", ": 1"});
  expect_refused("over.msh", with(kGmsh22, "14 1 1 1", "14 .1 .1 .1"), {"overlap", ": 1"});
  expect_refused("none.msh",
                 with(with(kGmsh22, "3 4 2 1 1 10 11 12 13", "3 15 0 10"),
                      "4 4 3 1 1 0 11 12 14 13", "4 15 0 10"),
                 {"no vertices"});
}

TEST_F(TetrahedralFile, AnyPrefixAndAnyGarbageIsReadOrRefused) {
  for (const std::string& whole :
       {std::string(kGmsh22), std::string(kGmsh41), binary_22(), binary_41()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      write("cut.msh", whole.substr(0, size));
      try {
        EXPECT_EQ(read_tetrahedral_mesh(path("cut.msh")).tetrahedra.cols(), 2) << size;
      } catch (const InputError&) {
      }
    }
  }
  std::mt19937 random(1);
  for (const std::string& whole : {std::string(kGmsh41), binary_22(), binary_41()}) {
    for (int round = 0; round < 500; ++round) {
      std::string bytes = whole;
      for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      write("noise.msh", bytes);
      try {
        read_tetrahedral_mesh(path("noise.msh"));
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace pliant
