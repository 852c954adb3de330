#pragma once

#include <string>
#include <vector>

#include "pliant/models/reduced/reduced_model.h"

namespace pliant {

/// A body of ours to study: its shape is a few formulas, cut into cubes of tetrahedra or filled
/// within its smooth surface.
struct ExampleBody {
  std::string name;
  TetrahedralMesh mesh;
  TriangleMesh surface = {};  ///< that the tetrahedra carry; without triangles: their boundary
  std::vector<int> fixed;     ///< vertices
  ElasticMaterial material;
  bool averaged = false;                            ///< strains, see StvkBody
  ReduceOptions reduction;                          ///< with the rank of the thesis
  int loaded = 0;                                   ///< the vertex that the studies pull at
  Eigen::Vector3d load = Eigen::Vector3d::UnitZ();  ///< unit direction of that pull
};

/// beam, basket, bridge, quadruped, tower, heart: bodies of the six kinds that the thesis studies,
/// as stiff as its split of coordinates needs them.
std::vector<std::string> thesis_body_names();
/// These, and soft_heart, rubber_bridge, rubber_tower, rubber_horse: smooth, of materials that such
/// things are cast of.
std::vector<std::string> example_names();
/// One line. Throws InputError as example_body() does.
std::string example_description(const std::string& name);

/// Throws InputError with the names and the nearest one for an unknown name.
ExampleBody example_body(const std::string& name);

}  // namespace pliant
