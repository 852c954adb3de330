#include "pliant/models/cloth/cloth.h"

#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/cell_shear_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/elements/cloth/triangle_strain_set.h"
#include "pliant/elements/cloth/warp_direction.h"
#include "pliant/elements/solids/material_damping.h"
#include "pliant/math/error.h"
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
  areas_ = voronoi_areas(geometry.mesh);
  system_.particles = Particles(geometry.mesh.vertices, material.areal_density * areas_);
  if (geometry.grid) {
    add_grid(*geometry.grid, material);
  } else {
    add_membrane(geometry.mesh, material);
  }
  add_bending(geometry, material);
  add_damping(system_, 0, material.damping);
}

void ClothModel::add_grid(const GridOptions& grid, const Material& material) {
  const FabricStiffness stiffness{material.stretch_warp, material.stretch_weft, material.shear};
  add_springs(system_, "stretch", grid_stretch_springs(grid, stiffness));
  if (material.grid_shear == Shear::kSprings) {
    add_springs(system_, "shear", grid_shear_springs(grid, material.shear, material.diagonals));
    return;
  }
  const std::vector<ShearCell> cells = grid_shear_cells(grid, material.shear);
  if (cells.empty()) return;
  system_.elements.push_back(std::make_unique<CellShearSet>(cells, particles().size()));
}

void ClothModel::add_membrane(const TriangleMesh& mesh, const Material& material) {
  MembraneMaterial membrane;
  membrane.warp = material.stretch_warp;
  membrane.weft = material.stretch_weft;
  membrane.shear = material.shear;
  if (membrane.warp + membrane.weft + membrane.shear == 0.0) return;
  Eigen::Matrix3Xd warp(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < warp.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Eigen::Vector3d a = mesh.vertices.col(v[1]) - mesh.vertices.col(v[0]);
    const Eigen::Vector3d b = mesh.vertices.col(v[2]) - mesh.vertices.col(v[0]);
    warp.col(t) = warp_within(material.warp.normalized(), a.cross(b).normalized());
  }
  system_.elements.push_back(std::make_unique<TriangleStrainSet>(mesh, warp, membrane));
}

void ClothModel::add_bending(const BodyGeometry& geometry, const Material& material) {
  if (material.bending_warp == 0.0 && material.bending_weft == 0.0) return;
  const double warp = material.bending_warp, weft = material.bending_weft;
  auto bending = geometry.grid ? std::make_unique<BendingSet>(*geometry.grid, warp, weft,
                                                              material.grid_shear == Shear::kCells)
                 : material.has_plates
                     ? BendingSet::plates(geometry.mesh, material.warp, warp, weft)
                     : std::make_unique<BendingSet>(geometry.mesh, material.warp, warp, weft);
  if (bending->size() > 0) system_.elements.push_back(std::move(bending));
}

std::map<std::string, Eigen::VectorXd> ClothModel::point_fields() const {
  const int n = particles().size();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n), count = Eigen::VectorXd::Zero(n);
  for (const auto& set : system_.elements) {
    if (const HasYarns* cloth = set->find<HasYarns>())
      cloth->add_strains(particles().x, sum, count);
  }
  std::map<std::string, Eigen::VectorXd> fields = {
      {"stretch", sum.cwiseQuotient(count.cwiseMax(1.0))}};
  if (wetness_ != nullptr) fields["wetness"] = *wetness_;
  return fields;
}

Eigen::Matrix3Xf ClothModel::particle_colors() const {
  Eigen::Matrix3Xf colors = Model::particle_colors();
  if (wetness_ == nullptr) return colors;
  const Eigen::RowVectorXf share =
      1.0f - (1.0f - kWetBrightness) * wetness_->cast<float>().transpose().array();
  return colors.array().rowwise() * share.array();
}

void ClothModel::set_mass(int i, double mass) {
  Particles& moved = particles();
  masses_changed |= mass != moved.mass[i];
  moved.mass[i] = mass;
  if (!moved.is_fixed(i)) moved.release(i);
}

StepPlan ClothModel::plan_step(double, StepReport&) {
  StepPlan plan;
  plan.system_changed = masses_changed;
  masses_changed = false;
  return plan;
}

namespace {

/// Refuses what would have no effect.
void check_shear(const ClothModel::Material& material) {
  if (material.diagonals != 2 && material.grid_shear == ClothModel::Shear::kCells) {
    throw InputError(
        "'diagonals' is 1, but counts springs, which `grid_shear: cells` has none of; write "
        "`grid_shear: springs` or leave it out");
  }
}

}  // namespace

ModelRegistry::Entry cloth_entry() {
  return {
      "cloth",
      "stretch along warp and weft, shear and bending: springs on grids, triangles on other meshes",
      {positive_parameter("areal_density", "kg/m^2", "0.15", 1e3, "mass per area"),
       number_parameter("stretch_warp", "N/m", "500", 0.0, 1e9,
                        "force per width and strain along warp, a grid's x direction"),
       number_parameter("stretch_weft", "N/m", "500", 0.0, 1e9,
                        "force per width and strain along weft, at right angles to warp"),
       number_parameter("shear", "N/m", "50", 0.0, 1e9, "shear force per width and shear angle"),
       number_parameter("bending", "N m", "1e-5", 0.0, 1e3, "bending stiffness; 0 has none"),
       number_parameter("bending_warp", "N m", "0", 0.0, 1e3,
                        "of what bends along warp; 0: as `bending`"),
       number_parameter("bending_weft", "N m", "0", 0.0, 1e3,
                        "of what bends along weft; 0: as `bending`"),
       material_damping_parameter(),
       vector_parameter("warp_direction", "", "[1, 0, 0]", 1e6,
                        "of a mesh at rest, in the body's frame: its part in a triangle's plane is "
                        "warp there; where it has none the axes move on, x to y to z to x"),
       choice_parameter(
           "grid_shear", "springs", {"springs", "cells"},
           "what shears on a grid: `springs` along the diagonals (Yamada 2013), which stiffen "
           "stretch by up to `shear`, or `cells`, which leave it alone and bend up to the edges, "
           "as "
           "named fabrics have"),
       choice_parameter(
           "mesh_bending", "hinges", {"hinges", "plates"},
           "what bends on a mesh: `hinges` at its edges, whose stiffness depends on how triangles "
           "lie, or `plates`, which converge on any mesh for some more time"),
       integer_parameter("diagonals", "2", 1, 2, "of `grid_shear: springs`: springs per cell")},
      {"cloth"},
      [](const Parameters& parameters, const BodyGeometry& geometry) {
        ClothModel::Material material;
        material.areal_density = parameters.number("areal_density");
        material.stretch_warp = parameters.number("stretch_warp");
        material.stretch_weft = parameters.number("stretch_weft");
        material.shear = parameters.number("shear");
        const auto bending = [&](const std::string& name) {
          const double own = parameters.number(name);
          return own > 0.0 ? own : parameters.number("bending");
        };
        material.bending_warp = bending("bending_warp");
        material.bending_weft = bending("bending_weft");
        if ((material.bending_warp > 0.0) != (material.bending_weft > 0.0)) {
          throw InputError(
              "'bending_warp' and 'bending_weft': one of them is 0 N m with `bending` 0; give "
              "both");
        }
        material.damping = parameters.number("damping");
        material.warp = parameters.vector("warp_direction");
        if (!(material.warp.norm() > 0.0)) {
          throw InputError("'warp_direction' is [0, 0, 0], but must point somewhere");
        }
        material.grid_shear = parameters.text("grid_shear") == "cells"
                                  ? ClothModel::Shear::kCells
                                  : ClothModel::Shear::kSprings;
        material.has_plates = parameters.text("mesh_bending") == "plates";
        material.diagonals = parameters.integer("diagonals");
        check_shear(material);
        return std::make_unique<ClothModel>(geometry, material);
      }};
}

}  // namespace pliant
