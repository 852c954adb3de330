#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pliant/core/carried_points.h"
#include "pliant/core/registry.h"
#include "pliant/core/system.h"
#include "pliant/geometry/grid.h"
#include "pliant/geometry/tetrahedral_mesh.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {

struct ReducedModel;

/// A body's rest shape.
struct BodyGeometry {
  TriangleMesh mesh;                ///< its surface; of cloth the vertices are the particles
  std::optional<GridOptions> grid;  ///< set when the mesh is a built-in grid
  std::optional<TetrahedralMesh> tetrahedra = {};  ///< set for a body with an inside
  Eigen::Matrix3Xd contact_points = {};            ///< on the surface of a body with an inside [m]
  std::shared_ptr<const ReducedModel> reduced = {};  ///< set for a body that was reduced
};

/// The physics and the state of a body.
class Model {
 public:
  virtual ~Model() = default;
  virtual std::string_view name() const = 0;
  virtual System& system() = 0;
  virtual const System& system() const = 0;
  Particles& particles() { return system().particles; }
  const Particles& particles() const { return system().particles; }

  /// What is drawn. Rebuilt only when topology changes.
  virtual const Eigen::Matrix3Xi& surface_triangles() const = 0;
  /// The vertices of what is drawn; null: they are the particles, in order.
  virtual const CarriedPoints* surface_points() const { return nullptr; }
  /// The points that touch; null: the particles.
  virtual const CarriedPoints* contact_points() const { return nullptr; }
  /// The particles' tetrahedra at rest; null for a model that has none.
  virtual const TetrahedralMesh* tetrahedra() const { return nullptr; }
  /// Rest area of the surface that belongs to each particle [m²].
  virtual const Eigen::VectorXd& particle_areas() const = 0;
  /// Scalar fields of the particles, by name; computed on request.
  virtual std::map<std::string, Eigen::VectorXd> point_fields() const = 0;
  /// Takes `other` in as a part of one system, so that both may touch: its particles follow this
  /// one's. Returns false, and nothing changed, for a model that cannot.
  virtual bool join(Model& /*other*/) { return false; }

  /// Moves the body, made at rest in its own frame, to where a scene wants it.
  virtual void place(const Eigen::Isometry3d& world_from_body);
  /// Of all that is not fixed [m/s].
  virtual void set_velocity(const Eigen::Vector3d& velocity);
  /// Why a scene may not fix vertices of this body; empty where it may.
  virtual std::string_view why_not_fix() const { return {}; }

  int surface_vertices() const;
  /// Where the surface's vertices are now, 3 x surface_vertices() [m].
  void surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const;
  /// The surface as it is now.
  TriangleMesh surface() const;
  /// What a field of the particles is at the surface's vertices.
  Eigen::VectorXd on_surface(const Eigen::VectorXd& field) const;

  Eigen::Vector3f color = Eigen::Vector3f(0.25f, 0.45f, 0.75f);  ///< rgb in [0, 1]
};

using ModelRegistry = Registry<Model, const BodyGeometry&>;

}  // namespace pliant
