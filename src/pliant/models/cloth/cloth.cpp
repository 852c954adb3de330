#include "pliant/models/cloth/cloth.h"

#include "pliant/elements/bending_set.h"
#include "pliant/elements/spring_set.h"
#include "pliant/models/cloth/cloth_springs.h"

namespace pliant {
namespace {

void add_springs(ProjectiveSystem& system, const std::string& name,
                 const std::vector<Spring>& springs) {
  if (springs.empty()) return;
  system.elements.push_back(std::make_unique<SpringSet>(name, springs, system.particles.size()));
}

}  // namespace

ClothModel::ClothModel(const BodyGeometry& geometry, const Material& material)
    : triangles_(geometry.mesh.triangles) {
  validate(geometry.mesh, "cloth");
  areas_ = vertex_areas(geometry.mesh);
  system_.particles = Particles(geometry.mesh.vertices, material.areal_density * areas_);
  const FabricStiffness stiffness{material.stretch_warp, material.stretch_weft, material.shear};
  if (geometry.grid) {
    add_springs(system_, "stretch", grid_stretch_springs(*geometry.grid, stiffness));
    add_springs(system_, "shear",
                grid_shear_springs(*geometry.grid, material.shear, material.diagonals));
  } else {
    add_springs(system_, "stretch", mesh_stretch_springs(geometry.mesh, stiffness));
  }
  if (material.bending > 0.0) {
    auto bending = std::make_unique<BendingSet>(geometry.mesh, material.bending);
    if (bending->size() > 0) system_.elements.push_back(std::move(bending));
  }
}

std::map<std::string, Eigen::VectorXd> ClothModel::point_fields() const {
  const int n = particles().size();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n), count = Eigen::VectorXd::Zero(n);
  for (const auto& set : system_.elements) {
    const auto* springs = dynamic_cast<const SpringSet*>(set.get());
    if (springs != nullptr && springs->name() == "stretch") {
      springs->add_strains(particles().x, sum, count);
    }
  }
  return {{"stretch", sum.cwiseQuotient(count.cwiseMax(1.0))}};
}

ModelRegistry::Entry cloth_entry() {
  return {
      "cloth",
      "point masses and springs: stretch along warp and weft, shear, bending",
      {positive_parameter("areal_density", "kg/m^2", "0.15", 1e3, "mass per area"),
       number_parameter("stretch_warp", "N/m", "500", 0.0, 1e9,
                        "force per width and strain along a grid's x direction"),
       number_parameter("stretch_weft", "N/m", "500", 0.0, 1e9,
                        "force per width and strain along a grid's y direction"),
       number_parameter("shear", "N/m", "50", 0.0, 1e9,
                        "shear force per width and shear angle; grids only: on other meshes the "
                        "edges' triangles resist shear"),
       number_parameter("bending", "N m", "1e-5", 0.0, 1e3, "bending stiffness; 0 has none"),
       integer_parameter("diagonals", "2", 1, 2, "shear springs per cell of a grid")},
      {"cloth"},
      [](const Parameters& parameters, const BodyGeometry& geometry) {
        ClothModel::Material material;
        material.areal_density = parameters.number("areal_density");
        material.stretch_warp = parameters.number("stretch_warp");
        material.stretch_weft = parameters.number("stretch_weft");
        material.shear = parameters.number("shear");
        material.bending = parameters.number("bending");
        material.diagonals = parameters.integer("diagonals");
        return std::make_unique<ClothModel>(geometry, material);
      }};
}

}  // namespace pliant
