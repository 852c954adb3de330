#pragma once

#include <memory>

#include "pliant/core/body/model.h"
#include "pliant/models/reduced/reduced_body_system.h"

namespace pliant {

/// A reduced St. Venant-Kirchhoff body in a scene. Its particles are the vertices of its mesh;
/// those that the reduction fixed stay where the scene puts the body.
class ReducedBody final : public Model {
 public:
  struct Options {
    RayleighDamping damping;
    double fast = 0.0;  ///< frequency from which on coordinates count as fast [Hz]; 0: h ω >= 1
  };

  /// `geometry` needs a reduced model and the points that touch. Throws InputError without one.
  ReducedBody(const BodyGeometry& geometry, const Options& options);

  std::string_view name() const override { return "reduced"; }
  bool is_solid() const override { return true; }
  ReducedBodySystem& system() override { return *system_; }
  const ReducedBodySystem& system() const override { return *system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  /// Null where its surface is that of its tetrahedra.
  const EmbeddedPoints* surface_points() const override {
    return surface_.size() > 0 ? &surface_ : nullptr;
  }
  const EmbeddedPoints* contact_points() const override { return &system_->touching(); }
  const TetrahedralMesh* tetrahedra() const override { return &model_->mesh; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  /// `displacement` [m]; `von_mises`, of Cauchy's stress, the mean of a vertex's tetrahedra [Pa].
  std::map<std::string, Eigen::VectorXd> point_fields() const override;
  void place(const Eigen::Isometry3d& world_from_body) override;
  /// p = Uᵀ M v with the consistent mass, of all that is not fixed.
  void set_velocity(const Eigen::Vector3d& velocity) override;
  std::string_view why_not_fix() const override;

 private:
  std::shared_ptr<const ReducedModel> model_;
  std::unique_ptr<ReducedBodySystem> system_;
  EmbeddedPoints surface_;
  Eigen::Matrix3Xi triangles_;
  Eigen::VectorXd areas_;
  Eigen::Matrix3d world_from_body_ = Eigen::Matrix3d::Identity();
};

ModelRegistry::Entry reduced_entry();

}  // namespace pliant
