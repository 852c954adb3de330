#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <random>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/mesh/grid.h"
#include "unit/geometry/io/mesh_file_fixture.h"

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
    for (std::size_t size = 0; size < bytes.size(); size += size < 30 ? 1 : 7) {
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

/// A binary glTF file of that text, with the lengths that its header and its chunk announce.
std::string glb(const std::string& json, std::uint32_t length, std::uint32_t chunk) {
  std::string bytes = "glTF";
  for (const std::uint32_t word : {2u, length, chunk}) {
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(word >> 8 * k & 0xFF);
  }
  return bytes + "JSON" + json;
}

/// COLLADA with these nodes in its library of nodes and in its scene.
std::string collada_with(const std::string& library, const std::string& nodes) {
  std::string text = collada("Z_UP");
  text.replace(text.find("<node id=\"n\">"), 13, nodes + "<node id=\"n\">");
  text.insert(text.find("<library_visual_scenes>"),
              "<library_nodes>" + library + "</library_nodes>");
  return text;
}

TEST_F(MeshFileRefusal, WhatAFileOnlyAnnouncesIsNotAllocated) {
  for (const std::uint32_t length : {22u, 4000000000u}) {
    expect_unreadable("header_only.glb", glb("{}", length, 4000000000u));
  }
  expect_unreadable("short.glb", glb("{}", 12, 2));
  for (const char* field :
       {"\"byteLength\": 44", "\"byteLength\": 36", "\"byteOffset\": 8", "\"count\": 3"}) {
    for (const char* number : {"4000000000", "1e30", "-1", "1e999"}) {
      std::string gltf = kGltf;
      const std::size_t at = gltf.find(field), colon = gltf.find(':', at) + 1;
      gltf.replace(colon, gltf.find_first_of(",}", colon) - colon, number);
      expect_unreadable("huge.gltf", gltf);
    }
  }
  for (const char* field :
       {"count=\"9\"", "count=\"3\"", "stride=\"3\"", "offset=\"0\"", "count=\"1\""}) {
    for (const char* number : {"4000000000", "-1"}) {
      std::string dae = collada("Z_UP");
      const std::size_t at = dae.find(field), quote = dae.find('"', at) + 1;
      dae.replace(quote, dae.find('"', quote) - quote, number);
      expect_unreadable("huge.dae", dae);
    }
  }
}

TEST_F(MeshFileRefusal, ListsThatEndAfterTheFileAreRefused) {
  const std::string header =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int int vertex_indices\nend_header\n";
  for (const char* count : {"4000000000", "-1", "1e30", "nan", "100"}) {
    expect_unreadable("list.ply", "ply\nformat ascii 1.0\n" + header + "0 0 0\n1 0 0\n0 1 0\n" +
                                      count + " 0 1 2\n");
  }
  for (const char* endianness : {"little", "big"}) {
    for (const char* count : {"\xFF\xFF\xFF\x7F", "\x7F\xFF\xFF\xFF", "\xFF\xFF\xFF\xFF"}) {
      expect_unreadable("list.ply", std::string("ply\nformat binary_") + endianness +
                                        "_endian 1.0\n" + header + std::string(36, '\0') + count +
                                        std::string(12, '\0'));
    }
  }
  // Values beyond their line would be taken for those of the next.
  expect_unreadable(
      "more.ply", "ply\nformat ascii 1.0\n" + header + "0 0 0 4000000000\n1 0 0\n0 1 0\n3 0 1 2\n");
}

TEST_F(MeshFileRefusal, NodesThatHoldThemselvesAreRefused) {
  const auto refused = [&](const std::string& name, const std::string& bytes,
                           const std::string& why) {
    write(name, bytes);
    expect_refusal([&] { read_triangle_mesh(path(name)); }, {path(name), why});
  };
  const std::string self = "<node id=\"m\"><instance_node url=\"#m\"/></node>";
  refused("self.dae", collada_with("", self), "'m' holds itself");
  refused("two.dae",
          collada_with("<node id=\"a\"><instance_node url=\"#b\"/></node>"
                       "<node id=\"b\"><node><instance_node url=\"#a\"/></node></node>",
                       "<node><instance_node url=\"#a\"/></node>"),
          "holds itself");
  refused("named.dae", collada_with("", "<node name=\"m\"><instance_node url=\"#m\"/></node>"),
          "holds itself");
  // A scene is a node to the importer.
  const std::string scene = "<visual_scene id=\"whole\">";
  std::string whole = collada_with("", "<node><instance_node url=\"#whole\"/></node>");
  const std::size_t at_scene = whole.find("<visual_scene");
  whole.replace(at_scene, whole.find('>', at_scene) + 1 - at_scene, scene);
  refused("scene.dae", whole, "'whole' holds itself");
  for (const char* child : {"\"children\": [0]", "\"children\": [1]"}) {
    std::string gltf = kGltf;
    const std::string nodes =
        std::string("\"nodes\": [{\"mesh\": 0, ") + child + "}, {\"children\": [0]}]";
    const std::size_t at = gltf.find("\"nodes\": [{\"mesh\"");
    gltf.replace(at, gltf.find("}]", at) + 2 - at, nodes);
    write("cycle.gltf", gltf);
    expect_refusal([&] { read_triangle_mesh(path("cycle.gltf")); }, {"cycle.gltf", "node '"});
  }
}

TEST_F(MeshFileRefusal, NestingThatGrowsWithoutEndIsRefused) {
  // Each node holds the next one twice: 2^40 in all.
  std::string library;
  for (int k = 0; k < 40; ++k) {
    const std::string next = "<instance_node url=\"#x" + std::to_string(k + 1) + "\"/>";
    library += "<node id=\"x" + std::to_string(k) + "\">" + next + next + "</node>";
  }
  library += "<node id=\"x40\"/>";
  expect_unreadable("doubling.dae",
                    collada_with(library, "<node><instance_node url=\"#x0\"/></node>"));
  std::string chain, deep, end;
  for (int k = 0; k < 100000; ++k) {
    chain += "<node id=\"c" + std::to_string(k) + "\"><instance_node url=\"#c" +
             std::to_string(k + 1) + "\"/></node>";
    deep += "<node>";
    end += "</node>";
  }
  chain += "<node id=\"c100000\"/>";
  expect_unreadable("chain.dae", collada_with(chain, "<node><instance_node url=\"#c0\"/></node>"));
  expect_unreadable("deep.dae", collada_with("", deep + end));
  std::string arrays = kGltf;
  arrays.insert(1, "\"extras\": " + std::string(100000, '[') + std::string(100000, ']') + ", ");
  expect_unreadable("arrays.gltf", arrays);
  std::string nodes = "\"nodes\": [{\"mesh\": 0, \"children\": [1]}";
  for (int k = 1; k < 100000; ++k) nodes += ", {\"children\": [" + std::to_string(k + 1) + "]}";
  std::string nested = kGltf;
  const std::size_t at = nested.find("\"nodes\": [{\"mesh\"");
  nested.replace(at, nested.find("}]", at) + 2 - at, nodes + ", {}]");
  expect_unreadable("nested.gltf", nested);
}

TEST_F(MeshFileRefusal, OtherFilesAreReadFromTheMeshsFolderAlone) {
  // Its two views of one buffer, which begins with the indices.
  const std::string data = [] {
    std::string bytes("\0\0\1\0\2\0\0\0", 8);
    const float numbers[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    return bytes.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
  }();
  std::filesystem::create_directory(path("meshes"));
  const auto with_buffer = [&](const std::string& uri) {
    std::string gltf = kGltf;
    const std::size_t at = gltf.find("\"data:");
    gltf.replace(at, gltf.find('"', at + 1) + 1 - at, "\"" + uri + "\"");
    write("meshes/part.gltf", gltf);
    return path("meshes/part.gltf");
  };
  write("meshes/data.bin", data);
  write("data.bin", data);
  EXPECT_EQ(read_triangle_mesh(with_buffer("data.bin")).triangles.cols(), 1);
  ASSERT_EQ(mkfifo(path("meshes/pipe").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  for (const std::string& uri :
       {std::string("../data.bin"), path("data.bin"), std::string("../pipe"), std::string("pipe"),
        std::string("/dev/zero"), std::string("."), std::string("missing.bin")}) {
    const std::string file = with_buffer(uri);
    expect_refusal([&] { read_triangle_mesh(file); }, {file, "'" + uri + "' is "});
  }
  // A library of materials is not needed, and no pipe is waited for.
  write("meshes/a.obj", "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  EXPECT_EQ(read_triangle_mesh(path("meshes/a.obj")).triangles.cols(), 1);
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
