#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/elements/solids/volume_set.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/solids.h"

namespace pliant {

/// One part of a body of tetrahedra.
struct SolidPart {
  TetrahedralMesh rest;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world from rest frame
  ElasticMaterial material{1e5, 0.3, 1000.0};
};

/// Parts of elastic tetrahedra in one system, each at rest in a frame of its own.
class SolidModel final : public Model {
 public:
  explicit SolidModel(const std::vector<SolidPart>& parts) : triangles_(3, 0) {
    Positions x;
    Eigen::VectorXd masses;
    for (const SolidPart& part : parts) {
      const auto first = x.cols(), count = part.rest.vertices.cols();
      firsts_.push_back(static_cast<int>(first));
      x.conservativeResize(3, first + count);
      x.rightCols(count) = part.pose * part.rest.vertices;
      masses.conservativeResize(first + count);
      masses.tail(count) = part.material.density * vertex_volumes(part.rest);
      rest_.vertices.conservativeResize(3, first + count);
      rest_.vertices.rightCols(count) = part.rest.vertices;
      const auto tetrahedra = part.rest.tetrahedra.cols();
      rest_.tetrahedra.conservativeResize(4, rest_.tetrahedra.cols() + tetrahedra);
      rest_.tetrahedra.rightCols(tetrahedra) =
          part.rest.tetrahedra.array() + static_cast<int>(first);
      add_elements(part);
    }
    system_.particles = Particles(x, masses);
    areas_ = Eigen::VectorXd::Zero(x.cols());
  }

  std::string_view name() const override { return "patch"; }
  System& system() override { return system_; }
  const System& system() const override { return system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  const TetrahedralMesh* tetrahedra() const override { return &rest_; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  std::map<std::string, Eigen::VectorXd> point_fields() const override { return {}; }

  int parts() const { return static_cast<int>(firsts_.size()); }
  /// The first particle of a part.
  int first(int part) const { return firsts_[static_cast<std::size_t>(part)]; }
  int count(int part) const {
    const bool last = part + 1 == static_cast<int>(firsts_.size());
    return (last ? static_cast<int>(rest_.vertices.cols()) : first(part + 1)) - first(part);
  }

 private:
  void add_elements(const SolidPart& part) {
    const TetrahedronStiffness stiffness = tetrahedron_stiffness(part.material);
    system_.elements.push_back(
        std::make_unique<TetrahedronSet>(part.rest, stiffness.corotated, firsts_.back()));
    if (stiffness.volume == 0.0) return;
    system_.elements.push_back(
        std::make_unique<VolumeSet>(part.rest, stiffness.volume, VolumeLimits(), firsts_.back()));
  }

  ProjectiveSystem system_;
  TetrahedralMesh rest_{Eigen::Matrix3Xd(3, 0), Eigen::Matrix4Xi(4, 0)};
  std::vector<int> firsts_;
  Eigen::Matrix3Xi triangles_;
  Eigen::VectorXd areas_;
};

/// What a test says about a scene with one body of solid parts.
struct SolidScene {
  std::vector<SolidPart> parts;
  std::vector<std::pair<std::string, ParameterText>> effects;  ///< in the registry's order
  std::vector<int> fixed;
  std::string solver = "newton";
  ParameterText solver_parameters = {{"iterations", "30"}, {"tolerance", "1e-8"}};
  double time_step = 0.005;  ///< [s]
};

inline std::unique_ptr<World> make_solid_world(const SolidScene& scene) {
  auto world = std::make_unique<World>(scene.time_step);
  Body& body = world->add_body("solid", std::make_unique<SolidModel>(scene.parts));
  for (const auto& [name, parameters] : scene.effects) {
    world->add_effect(body, effect_registry(), name, parameters, "test");
  }
  for (int i : scene.fixed) body.particles().fix(i);
  body.solver = make_solver(scene.solver, scene.solver_parameters);
  body.solver->prepare(body.model->system(), scene.time_step);
  world->set_initial_state();
  return world;
}

inline const SolidModel& solid_of(const World& world) {
  return dynamic_cast<const SolidModel&>(*world.bodies().front().model);
}

/// The present positions of a part.
inline Positions part_positions(const World& world, int part) {
  const SolidModel& model = solid_of(world);
  return model.particles().x.middleCols(model.first(part), model.count(part));
}

}  // namespace pliant
