#ifndef PLIANT_TESTS_UNIT_GEOMETRY_MESH_FILE_FIXTURE_H_
#define PLIANT_TESTS_UNIT_GEOMETRY_MESH_FILE_FIXTURE_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/io/mesh_file.h"
#include "support/expect_refusal.h"

namespace pliant {

// A folder of its own for every test, and the content of small files.
class MeshFileFixture : public ::testing::Test {
 protected:
  MeshFileFixture() {
    std::string name = (std::filesystem::temp_directory_path() / "pliant_mesh_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~MeshFileFixture() override { std::filesystem::remove_all(folder_); }

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

inline TriangleMesh box() { return Box(Eigen::Vector3d(1.0, 2.0, 4.0)).surface(); }

inline std::string binary_stl(const TriangleMesh& mesh) {
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
inline const char kGltf[] = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
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
inline std::string collada(const std::string& up_axis) {
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

}  // namespace pliant

#endif  // PLIANT_TESTS_UNIT_GEOMETRY_MESH_FILE_FIXTURE_H_
