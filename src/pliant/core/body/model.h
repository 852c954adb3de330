#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pliant/core/body/embedded_points.h"
#include "pliant/core/body/settable_field.h"
#include "pliant/core/body/surface_bends.h"
#include "pliant/core/registry.h"
#include "pliant/core/system/system.h"
#include "pliant/geometry/mesh/grid.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/mesh/volume_moments.h"
#include "pliant/geometry/search/normal_cones.h"
#include "pliant/math/offers.h"

namespace pliant {

struct Body;
struct Obstacle;
struct Reaction;
struct ReducedModel;
struct StepReport;
struct ResidentRun;

/// A body's rest shape.
struct BodyGeometry {
  TriangleMesh mesh;                ///< its surface; of cloth the vertices are the particles
  std::optional<GridOptions> grid;  ///< set when the mesh is a built-in grid
  std::optional<TetrahedralMesh> tetrahedra = {};  ///< set for a body with an inside
  Eigen::Matrix3Xd contact_points = {};            ///< on the surface of a body with an inside [m]
  Eigen::Matrix3Xd contact_normals = {};  ///< there, where the surface is smooth; else empty
  std::shared_ptr<const NormalCones> cones = {};  ///< of a rigid body, of these points; may be null
  std::shared_ptr<const ReducedModel> reduced = {};  ///< set for a body that was reduced
  Eigen::Matrix3Xd interior_points = {};             ///< that fill a body of particles evenly [m]
  double volume = 0.0;                               ///< of a body of particles [m³]
  std::optional<VolumeMoments> moments = {};  ///< where they are known better than of the mesh
};

/// How a model wants its next step to be taken.
struct StepPlan {
  int substeps = 1;             ///< equal ones, which the solver takes one after the other
  bool system_changed = false;  ///< elements are no longer what the solver was prepared for
  std::string refusal = {};     ///< not empty: why the step cannot be taken, and what to do
};

/// The physics and the state of a body.
class Model : public Offers {
 public:
  virtual std::string_view name() const = 0;
  virtual System& system() = 0;
  virtual const System& system() const = 0;
  Particles& particles() { return system().particles; }
  const Particles& particles() const { return system().particles; }

  /// What is drawn; the same triangles all the time unless surface_changes().
  virtual const Eigen::Matrix3Xi& surface_triangles() const = 0;
  /// Whether the surface is made anew from the particles for each state: triangles and vertices
  /// then hold until the particles move.
  virtual bool surface_changes() const { return false; }
  /// The vertices of what is drawn; null: they are the particles, in order.
  virtual const EmbeddedPoints* surface_points() const { return nullptr; }
  /// Whether its surface is closed, outward, and full of what it is made of.
  virtual bool is_solid() const { return false; }
  /// Whether it keeps its shape, to round-off.
  virtual bool is_rigid() const { return false; }
  /// The points that touch; null: the particles.
  virtual const EmbeddedPoints* contact_points() const { return nullptr; }
  /// How a smooth surface bends about these; null: it is not smooth.
  virtual const SurfaceBends* surface_bends() const { return nullptr; }
  /// Of a body that keeps its shape, the directions in which it looks about these, at rest; null:
  /// they are not known.
  virtual const NormalCones* normal_cones() const { return nullptr; }
  /// How such a body is turned now, from rest.
  virtual Eigen::Matrix3d turn() const { return Eigen::Matrix3d::Identity(); }
  /// Volumes of its particles, where these are loose and touch as balls [m³]; else null.
  virtual const Eigen::VectorXd* ball_volumes() const { return nullptr; }
  /// The points on which users' forces act; null: the particles.
  virtual const EmbeddedPoints* force_points() const { return nullptr; }
  /// The particles' tetrahedra at rest; null for a model that has none.
  virtual const TetrahedralMesh* tetrahedra() const { return nullptr; }
  /// Rest area of the surface that belongs to each particle [m²].
  virtual const Eigen::VectorXd& particle_areas() const = 0;
  /// Scalar fields of the particles, by name; computed on request.
  virtual std::map<std::string, Eigen::VectorXd> point_fields() const = 0;
  /// What of its particles a user may set while it runs.
  virtual std::vector<SettableField> settable_fields() { return {}; }
  /// Takes `other` in as a part of one system, so that both may touch: its particles follow this
  /// one's. Returns false, and nothing changed, for a model that cannot.
  virtual bool join(Model& /*other*/) { return false; }
  /// Whether it joins others of its kind also where a scene does not name `self_contact`.
  virtual bool always_joins() const { return false; }

  /// Whether it does anything of its own accord around the solver's steps.
  virtual bool acts_around_steps() const { return false; }
  /// Whether it does now what integrations of second order know nothing of.
  virtual bool needs_first_order() const { return false; }
  /// What it does then. Before a step of `dt` [s]:
  virtual StepPlan plan_step(double /*dt*/, StepReport& /*report*/) { return {}; }
  /// Before each substep, `dt` [s] long: adds to the system's external forces.
  virtual void before_solver(Body& /*body*/, const std::vector<Obstacle>& /*obstacles*/,
                             double /*dt*/) {}
  /// After it, where the state is finite.
  virtual void after_solver(Body& /*body*/, double /*dt*/) {}
  /// Adds the forces of the last substep on each obstacle, besides those of effects.
  virtual void add_reactions(std::vector<Reaction>& /*reactions*/) const {}
  /// Tells in how many substeps each step of a resident run is taken, and what it does in each.
  /// False: it has to look before each step; then there is no such run.
  virtual bool join_resident_run(ResidentRun& /*run*/) const { return !acts_around_steps(); }
  /// So many steps of a resident run were taken.
  virtual void after_resident_run(const ResidentRun& /*run*/, int /*steps*/) {}
  /// Whether elements come and go while it runs, so that a saved state may have others.
  virtual bool system_varies() const { return false; }

  /// Moves the body, made at rest in its own frame, to where a scene wants it.
  virtual void place(const Eigen::Isometry3d& world_from_body);
  /// Of all that is not fixed [m/s].
  virtual void set_velocity(const Eigen::Vector3d& velocity);
  /// Why a scene may not fix vertices of this body; empty where it may.
  virtual std::string_view why_not_fix() const { return {}; }

  virtual int surface_vertices() const;
  /// Where the surface's vertices are now, 3 x surface_vertices() [m].
  virtual void surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const;
  /// Where they are while that alone is known of the body (Readback::kSurface); null: where the
  /// particles are.
  void set_seen_surface(const Positions* vertices) { seen_surface_ = vertices; }
  /// The surface as it is now.
  TriangleMesh surface() const;
  /// What a field of the particles is at the surface's vertices.
  virtual Eigen::VectorXd on_surface(const Eigen::VectorXd& field) const;
  /// rgb in [0, 1] of the particles and of the surface's vertices, one column each.
  virtual Eigen::Matrix3Xf particle_colors() const;
  virtual Eigen::Matrix3Xf surface_colors() const;

  Eigen::Vector3f color = Eigen::Vector3f(0.25f, 0.45f, 0.75f);  ///< rgb in [0, 1]

 private:
  const Positions* seen_surface_ = nullptr;
};

using ModelRegistry = Registry<Model, const BodyGeometry&>;

}  // namespace pliant
