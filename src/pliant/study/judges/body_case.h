#pragma once

#include <memory>
#include <string>

#include "pliant/core/world.h"
#include "pliant/elements/solids/elastic_material.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/study/judges/held_coordinates.h"

namespace pliant {

/// A world of one body without effects, which a judge supports and loads. In equilibrium it is
/// taken by `newton` in steps so long that inertia has no part in it.
class BodyCase {
 public:
  /// Of tetrahedra with averaged strains (`strain: averaged`).
  BodyCase(TetrahedralMesh mesh, const ElasticMaterial& material, double time_step);
  BodyCase(std::unique_ptr<Model> model, double time_step);

  void fix(int vertex) { particles().fix(vertex); }
  void hold(const HeldCoordinates::Held& held) { held_->add(held); }
  /// Plane strain: the coordinate z of all vertices, so stiffly that it gives by 1e-4 of what it
  /// would if it were free. `stiffness`: Young's modulus times the depth [N/m].
  void hold_plane(double stiffness);
  void set_loads(const Forces& loads);
  /// Of gravity, on what is not fixed. [m/s²]
  void set_weight(const Eigen::Vector3d& acceleration);
  /// The supports and loads are all there.
  void start(const std::string& time_integration = "implicit_euler");
  /// Raises the loads in equal `stages`, each of which begins where the last one ended.
  void load(int stages);
  /// One step. Throws std::runtime_error where it is not taken, or not solved.
  void step();

  World& world() { return world_; }
  Body& body() { return world_.bodies().front(); }
  Particles& particles() { return body().particles(); }
  const Positions& rest() const { return rest_; }
  const HeldCoordinates& held() const { return *held_; }

 private:
  World world_;
  Positions rest_;
  HeldCoordinates* held_ = nullptr;  // of the body's system
  DeadLoads* loads_ = nullptr;       // likewise, or none
};

}  // namespace pliant
