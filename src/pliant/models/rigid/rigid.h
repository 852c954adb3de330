#pragma once

#include "pliant/core/body/model.h"
#include "pliant/models/rigid/rigid_motion.h"

namespace pliant {

/// Four particles at (±a, ±b, ±c) along three axes, in the order of signs().
struct RigidShape {
  using Corners = Eigen::Matrix<double, 3, 4>;
  Eigen::Vector3d half;  ///< a, b, c [m]

  static Corners signs();
  /// Particles from their centre, for such axes [m].
  Corners arms(const Eigen::Matrix3d& axes) const { return axes * half.asDiagonal() * signs(); }
  /// The axes nearest to particles at `x`, as columns.
  Eigen::Matrix3d axes(const Positions& x) const;
};

class RigidSystem final : public ProjectiveSystem {
 public:
  RigidShape shape;
  void keep_rigid(Positions& x) const override;
};

/// A free rigid body: four particles of a quarter of its mass each, at (±a, ±b, ±c) along its
/// principal axes, which together have its mass, centre and moments of inertia, held in their shape
/// by one stiff cluster, and a surface that they carry. So contact, forces and solvers treat it as
/// any other body. What a step leaves of its shape is made rigid again, and it turns by a
/// second-order rule of its own instead of implicit Euler, which would slow its spin.
class RigidModel final : public Model {
 public:
  /// `density` [kg/m³]; `mass` [kg], where it is above 0, instead.
  struct Material {
    double density = 1000.0;
    double mass = 0.0;
  };
  /// Throws InputError for a body that is not closed or has no volume.
  RigidModel(const BodyGeometry& geometry, const Material& material);

  std::string_view name() const override { return "rigid"; }
  bool is_solid() const override { return true; }
  bool is_rigid() const override { return true; }
  System& system() override { return system_; }
  const System& system() const override { return system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  const EmbeddedPoints* surface_points() const override { return &surface_; }
  const EmbeddedPoints* contact_points() const override { return &contact_; }
  const SurfaceBends* surface_bends() const override { return &bends_; }
  const NormalCones* normal_cones() const override { return cones_.get(); }
  Eigen::Matrix3d turn() const override { return axes() * axes_at_rest_.transpose(); }
  const EmbeddedPoints* force_points() const override { return &contact_; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  std::map<std::string, Eigen::VectorXd> point_fields() const override { return {}; }
  std::string_view why_not_fix() const override;

  bool acts_around_steps() const override { return true; }
  void before_solver(Body& body, const std::vector<Obstacle>& obstacles, double dt) override;
  void after_solver(Body& body, double dt) override;

  double mass() const { return particles().mass.sum(); }       ///< [kg]
  const Eigen::Vector3d& moments() const { return moments_; }  ///< principal, of inertia [kg m²]
  /// The principal axes now, as columns.
  Eigen::Matrix3d axes() const { return system_.shape.axes(particles().x); }
  /// About the centre of mass, of particles at `x` with velocities `v` [kg m²/s].
  static Eigen::Vector3d angular_momentum(const Particles& particles, const Positions& x,
                                          const Eigen::Matrix3Xd& v);

 private:
  RigidSystem system_;
  Eigen::Vector3d moments_;
  Eigen::Matrix3Xi triangles_;
  EmbeddedPoints surface_, contact_;
  SurfaceBends bends_;
  std::shared_ptr<const NormalCones> cones_;
  Eigen::Matrix3d axes_at_rest_;
  Eigen::VectorXd areas_;
  RigidShape::Corners turning_ =
      RigidShape::Corners::Zero();  // forces that take the prediction to the free rotation [N]
};

ModelRegistry::Entry rigid_entry();

}  // namespace pliant
