#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pliant/core/registry.h"
#include "pliant/core/system.h"
#include "pliant/geometry/grid.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {

/// Where a body's particles are at rest.
struct BodyGeometry {
  TriangleMesh mesh;
  std::optional<GridOptions> grid;  ///< set when the mesh is a built-in grid
};

/// The physics and the state of a body.
class Model {
 public:
  virtual ~Model() = default;
  virtual std::string_view name() const = 0;
  virtual System& system() = 0;
  virtual const System& system() const = 0;
  /// Particles of the system; every model of the framework has them.
  virtual Particles& particles() = 0;
  virtual const Particles& particles() const = 0;

  /// What is drawn; its vertices are the particles, in order. Rebuilt only when topology changes.
  virtual const Eigen::Matrix3Xi& surface_triangles() const = 0;
  /// Rest area that belongs to each particle [m^2].
  virtual const Eigen::VectorXd& particle_areas() const = 0;
  /// Scalar fields of the points, by name; computed on request.
  virtual std::map<std::string, Eigen::VectorXd> point_fields() const = 0;
  virtual double elastic_energy() const = 0;                     ///< [J]
  Eigen::Vector3f color = Eigen::Vector3f(0.25f, 0.45f, 0.75f);  ///< rgb in [0, 1]
};

using ModelRegistry = Registry<Model, const BodyGeometry&>;

}  // namespace pliant
