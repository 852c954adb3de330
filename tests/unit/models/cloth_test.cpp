#include "pliant/models/cloth/cloth.h"

#include <gtest/gtest.h>

#include "pliant/models/registry.h"
#include "support/expect_refusal.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

const GridOptions kGrid{0.5, 0.4, 6, 5};

std::vector<std::string> set_names(Model& model) {
  std::vector<std::string> names;
  for (const auto& set : projective_system(model).elements) names.emplace_back(set->name());
  return names;
}

std::unique_ptr<Model> make_cloth(const ParameterText& text, bool as_grid = true) {
  const auto& entry = model_registry().find("cloth");
  BodyGeometry geometry{make_grid(kGrid), {}};
  if (as_grid) geometry.grid = kGrid;
  return entry.make(parse_parameters(entry.parameters, text, "test"), geometry);
}

TEST(Cloth, MassIsAreaTimesDensity) {
  const auto cloth = make_cloth({{"areal_density", "0.3"}});
  EXPECT_EQ(cloth->name(), "cloth");
  EXPECT_NEAR(cloth->particles().mass.sum(), 0.3 * 0.2, 1e-15);
  EXPECT_NEAR(cloth->particle_areas().sum(), 0.2, 1e-15);
  EXPECT_EQ(cloth->particles().size(), 30);
  EXPECT_EQ(cloth->surface_triangles().cols(), 40);
}

TEST(Cloth, HoldsOnlyTheElementsItsMaterialNeeds) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(set_names(*make_cloth({})), (Names{"stretch", "shear", "bending"}));
  EXPECT_EQ(set_names(*make_cloth({{"bending", "0"}})), (Names{"stretch", "shear"}));
  EXPECT_EQ(set_names(*make_cloth({{"shear", "0"}, {"bending", "0"}})), (Names{"stretch"}));
  EXPECT_EQ(set_names(*make_cloth({}, false)), (Names{"triangle_strain", "bending"}));
  const ParameterText nothing{
      {"stretch_warp", "0"}, {"stretch_weft", "0"}, {"shear", "0"}, {"bending", "0"}};
  EXPECT_TRUE(set_names(*make_cloth(nothing)).empty());
}

TEST(Cloth, DiagonalsChangeTheCountNotTheStiffness) {
  const auto one = make_cloth({{"diagonals", "1"}}), two = make_cloth({{"diagonals", "2"}});
  EXPECT_EQ(projective_system(*one).elements[1]->size(), 20);
  EXPECT_EQ(projective_system(*two).elements[1]->size(), 40);
  const auto cells = make_cloth({{"grid_shear", "cells"}});
  EXPECT_EQ(set_names(*cells), set_names(*two));
  EXPECT_EQ(projective_system(*cells).elements[1]->size(), 20) << "one a cell";
}

TEST(Cloth, RestsWithoutEnergy) {
  EXPECT_NEAR(make_cloth({})->system().elastic_energy(), 0.0, 1e-22);
  EXPECT_NEAR(make_cloth({}, false)->system().elastic_energy(), 0.0, 1e-22);
}

TEST(Cloth, PointFieldsGiveTheStrain) {
  for (const bool as_grid : {true, false}) {
    const auto cloth = make_cloth({}, as_grid);
    cloth->particles().x *= 1.25;
    const auto fields = cloth->point_fields();
    ASSERT_EQ(fields.count("stretch"), 1u);
    EXPECT_TRUE(fields.at("stretch").isApproxToConstant(0.25, 1e-12));
  }
}

/// Energy of a mesh's cloth that is stretched by 1 % along x, sheared or bent.
double energy_of(const ParameterText& material, const Eigen::Matrix3d& map) {
  const auto cloth = make_cloth(material, false);
  cloth->particles().x = (map * cloth->particles().x).eval();
  return cloth->system().elastic_energy();
}

TEST(Cloth, MeshesAreAsStiffAlongWarpAndWeftAsTheirMaterial) {
  const double area = 0.5 * 0.4;
  Eigen::Matrix3d along_x = Eigen::Matrix3d::Identity(), along_y = along_x, shear = along_x;
  along_x(0, 0) = along_y(1, 1) = 1.01;
  shear(0, 1) = 1e-4;  // energy ½ G γ² to the second order of γ
  ParameterText material = {{"stretch_warp", "300"}, {"stretch_weft", "100"}, {"shear", "40"}};
  EXPECT_NEAR(energy_of(material, along_x), 0.5 * 300.0 * 1e-4 * area, 1e-12);
  EXPECT_NEAR(energy_of(material, along_y), 0.5 * 100.0 * 1e-4 * area, 1e-12);
  const double sheared = 0.5 * 40.0 * 1e-8 * area;
  EXPECT_NEAR(energy_of(material, shear), sheared, 1e-3 * sheared);
  material["warp_direction"] = "[0, 2, 0]";
  EXPECT_NEAR(energy_of(material, along_x), 0.5 * 100.0 * 1e-4 * area, 1e-12);
  EXPECT_NEAR(energy_of(material, along_y), 0.5 * 300.0 * 1e-4 * area, 1e-12);
}

TEST(Cloth, RefusesBadMeshes) {
  BodyGeometry geometry{make_grid(kGrid), {}};
  geometry.mesh.triangles(0, 3) = 1000;
  expect_refusal([&] { ClothModel(geometry, {}); }, {"cloth", "1 triangles name vertices outside"});
  geometry.mesh = make_grid(kGrid);
  geometry.mesh.vertices(2, 4) = std::nan("");
  expect_refusal([&] { ClothModel(geometry, {}); }, {"cloth", "4"});
  geometry.mesh = TriangleMesh();
  expect_refusal([&] { ClothModel(geometry, {}); }, {"cloth"});
}

TEST(Cloth, RefusesBadMaterials) {
  expect_refusal([] { make_cloth({{"areal_density", "0"}}); }, {"'areal_density'", "kg/m^2"});
  expect_refusal([] { make_cloth({{"shear", "-1"}}); }, {"'shear'", "N/m"});
  expect_refusal([] { make_cloth({{"diagonals", "3"}}); }, {"'diagonals'", "<= 2"});
  expect_refusal(
      [] {
        make_cloth({{"grid_shear", "cells"}, {"diagonals", "1"}});
      },
      {"'diagonals' is 1", "grid_shear"});
  expect_refusal(
      [] {
        make_cloth({{"grid_shear", "spring"}});
      },
      {"unknown grid_shear 'spring'", "springs"});
  expect_refusal([] { make_cloth({{"bending", "0"}, {"bending_warp", "1"}}); }, {"bending_weft"});
  expect_refusal([] { make_cloth({{"warp_direction", "[0, 0, 0]"}}); }, {"warp_direction"});
  expect_refusal([] { make_cloth({{"bendin", "1"}}); }, {"did you mean 'bending'"});
}

}  // namespace
}  // namespace pliant
