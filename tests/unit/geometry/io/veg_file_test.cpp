// Volumetric meshes of the Vega FEM library.
#include "pliant/geometry/io/veg_file.h"

#include <gtest/gtest.h>

#include "pliant/geometry/io/included_lines.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "unit/geometry/io/mesh_file_fixture.h"

namespace pliant {
namespace {

// Two tetrahedra, the second wound wrongly, and a vertex in none.
const char kVeg[] = R"(# Vega mesh file.
*VERTICES
6 3 0 0
1 0 0 0
2, 1, 0, 0
3 0 1 0
4 7 7 7
5 0 0 1   # comma and space are alike
6 1 1 1

*ELEMENTS
TET
2 4 0
1 1 2 3 5
2 2 3 6 5

*MATERIAL soft rubber
ENU, 1100, 2.5e6, 0.45
*MATERIAL unused
ENU, 7800, 2e11, 0.3
*SET all
1,
2
*REGION
all, softrubber
)";

const char kRest[] =
    "*ELEMENTS\nTET\n1 4 0\n0 0 1 2 3\n*MATERIAL m\nENU, 1, 2, 0\n*REGION\nallElements, m\n";

class VegFile : public MeshFileFixture {
 protected:
  MeshWithMaterial read_text(const std::string& text) const {
    return read_tetrahedral_file(write("body.veg", text));
  }
  void expect_refused(const std::string& text, std::vector<std::string> parts) const {
    write("body.veg", text);
    parts.emplace_back("body.veg");
    expect_refusal([&] { read_tetrahedral_file(path("body.veg")); }, parts);
  }
  /// kVeg with `other` in the place of `old`.
  void expect_refused_with(const std::string& old, const std::string& other,
                           const std::vector<std::string>& parts) const {
    std::string text = kVeg;
    const std::size_t at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    expect_refused(text.replace(at, old.size(), other), parts);
  }
};

TEST_F(VegFile, ReadsTetrahedraAndTheirMaterial) {
  const MeshWithMaterial file = read_text(kVeg);
  ASSERT_EQ(file.mesh.vertices.cols(), 5) << "without the one that nothing uses";
  EXPECT_EQ(file.mesh.vertices.col(4), Eigen::Vector3d(1, 1, 1));
  ASSERT_EQ(file.mesh.tetrahedra.cols(), 2);
  EXPECT_EQ(file.mesh.tetrahedra.col(0), Eigen::Vector4i(0, 1, 2, 3));
  EXPECT_NEAR(volumes(file.mesh)[1], 1.0 / 3.0, 1e-16) << "wound the right way";
  ASSERT_TRUE(file.material.has_value());
  EXPECT_EQ(file.material->name, "softrubber") << "spaces in names do not count there";
  EXPECT_EQ(file.material->density, 1100.0);
  EXPECT_EQ(file.material->young, 2.5e6);
  EXPECT_EQ(file.material->poisson, 0.45);
}

TEST_F(VegFile, CountsFromZeroWhereTheFirstIsZeroAndNeedsNoMaterial) {
  const std::string vertices = "*VERTICES\n4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
  const MeshWithMaterial file = read_text(vertices + kRest);
  EXPECT_EQ(file.mesh.tetrahedra.col(0), Eigen::Vector4i(0, 1, 2, 3));
  EXPECT_EQ(file.material->young, 2.0);
  EXPECT_FALSE(read_text(vertices + "*ELEMENTS\nTETS\n1 4 0\n1 0 1 2 3\n").material.has_value());
}

TEST_F(VegFile, IncludesWhatStandsBesideIt) {
  write("body.1.node", "4 3 1 1\n0 0 0 0 .5 1\n1 1 0 0 .5 1\n2 0 1 0 .5 1\n3 0 0 1 .5 0\n# end\n");
  const std::string text = std::string("*VERTICES\n*INCLUDE body.1.node\n") + kRest;
  EXPECT_EQ(read_text(text).mesh.vertices.cols(), 4);
  write("body.1.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 one 0\n");
  expect_refusal([&] { read_text(text); }, {"body.1.node", "line 4", "'one'"});
  expect_refused("*INCLUDE\n", {"line 1", "no file"});
  expect_refused("*INCLUDE none.veg\n", {"line 1", "'none.veg' is not there"});
  expect_refused("*INCLUDE ../body.veg\n", {"line 1", "outside of the mesh's folder"});
  expect_refused("\n*INCLUDE body.veg\n", {"line 2", "'body.veg' includes itself"});
  write("empty.veg", "# nothing\n");
  std::string many;
  for (int k = 0; k <= IncludedLines::kMaxIncludes; ++k) many += "*INCLUDE empty.veg\n";
  expect_refused(many, {"line 65", "more than 64 files"});
}

TEST_F(VegFile, OfSeveralRegionsTheLastCounts) {
  const std::string once = std::string(kVeg) + "*SET second\n2\n*REGION\nsecond, unused\n";
  expect_refused(once, {"elements 1 and 2", "'softrubber' and 'unused'", "a body has one"});
  EXPECT_EQ(read_text(once + "*REGION\nallElements, unused\n").material->density, 7800.0);
}

TEST_F(VegFile, RefusalsOfSectionsSayWhatAndWhere) {
  expect_refused("", {"no section *VERTICES"});
  expect_refused("1 2 3\n", {"line 1", "a section should begin here"});
  expect_refused_with("*SET", "*SETS", {"line 21", "unknown section '*SETS'", "'*SET'"});
  expect_refused("*VERTICES\n1 3 0 0\n1 0 0 0\n", {"no section *ELEMENTS"});
  expect_refused(std::string(kVeg) + "*VERTICES\n", {"*VERTICES is there twice"});
  expect_refused(std::string(kVeg) + "*ELEMENTS\n", {"*ELEMENTS is there twice"});
  expect_refused(std::string(kVeg) + "*REGION\n", {"ends before a set and its material"});
  expect_refused(std::string(kVeg) + "*REGION\nall\n", {"a region is the name of a set"});
  expect_refused(std::string(kVeg) + "*SET\n1\n", {"*SET has no name"});
  expect_refused(std::string(kVeg) + "*SET all\n1\n", {"set 'all' is there twice"});
  expect_refused(std::string(kVeg) + "*SET allElements\n1\n", {"'allElements' is there already"});
  std::string many = kVeg;
  for (int k = 0; k < 1000; ++k) many += "*REGION\nall, unused\n";
  expect_refused(many, {"more than 1000 materials, sets or regions"});
}

TEST_F(VegFile, RefusalsOfRowsSayWhatAndWhere) {
  expect_refused_with("6 3 0 0", "60000000 3 0 0",
                      {"line 3", "the number of vertices is 60000000", "[1, 40000000]"});
  expect_refused_with("6 3 0 0", "6 2 0 0", {"line 3", "2 numbers", "allowed is 3"});
  expect_refused_with("6 3 0 0", "6 3 101 0", {"line 3", "101 attributes"});
  expect_refused_with("6 3 0 0", "7 3 0 0", {"6 of 7 vertices are there"});
  expect_refused_with("6 3 0 0", "5 3 0 0", {"line 9", "more than 5 vertices"});
  expect_refused_with("3 0 1 0", "3 0 1", {"line 6", "3 numbers where 4 should be"});
  expect_refused_with("3 0 1 0", "3 0 one 0", {"line 6", "'one' should be a number"});
  expect_refused_with("3 0 1 0", "9 0 1 0", {"line 6", "number 9 where 3", "in order"});
  expect_refused_with("3 0 1 0", "3 0 inf 0", {"line 6", "vertex 3 is not finite"});
  expect_refused_with("TET\n", "CUBIC\n", {"line 12", "cubes are not read"});
  expect_refused_with("TET\n", "TRI\n", {"line 12", "unknown kind of elements 'TRI'"});
  expect_refused_with("2 4 0", "2 10 0", {"line 13", "10 numbers", "allowed is 4"});
  expect_refused_with("2 4 0", "10000001 4 0", {"more than 10000000 tetrahedra"});
  expect_refused_with("2 2 3 6 5", "2 2 3 7 5", {"element 2 names vertex 7"});
  expect_refused_with("2 2 3 6 5", "2 2 3 0 5", {"element 2 names vertex 0"});
  expect_refused_with("2 2 3 6 5", "2 2 3 2.5 5", {"line 15", "'2.5' should be a whole number"});
}

TEST_F(VegFile, RefusalsOfMaterialsSayWhatAndWhere) {
  expect_refused_with("ENU, 1100", "MOONEYRIVLIN, 1100",
                      {"line 18", "'softrubber' is MOONEYRIVLIN", "only ENU"});
  expect_refused_with("ENU, 1100, 2.5e6, 0.45", "ENU, 1100, 2.5e6", {"line 18", "three numbers"});
  expect_refused_with("1100", "0", {"line 18", "density is 0"});
  expect_refused_with("2.5e6", "-1", {"line 18", "Young's modulus is -1"});
  expect_refused_with("2.5e6", "inf", {"line 18", "Young's modulus is inf"});
  expect_refused_with("0.45", "0.5", {"line 18", "Poisson's ratio is 0.5", "(-1, 0.5)"});
  expect_refused_with("*MATERIAL soft rubber", "*MATERIAL", {"line 17", "no name"});
  expect_refused_with("*MATERIAL unused", "*MATERIAL softrubber", {"line 19", "twice"});
  expect_refused_with("all, softrubber", "all, hard", {"names material 'hard': none"});
  expect_refused_with("all, softrubber", "some, softrubber", {"names set 'some': none"});
  expect_refused_with("1,\n2\n", "1\n", {"element 2 is in no region"});
  expect_refused_with("1,\n2\n", "1, 2, 3\n", {"set 'all' names element 3"});
}

TEST_F(VegFile, AnyPrefixIsReadOrRefused) {
  const std::string whole = kVeg;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    try {
      read_text(whole.substr(0, size));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("body.veg"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace pliant
