#pragma once

#include <string>
#include <vector>

#include "pliant/core/body/model.h"
#include "pliant/elements/solids/elastic_material.h"

namespace pliant {

/// What one tetrahedron shows.
struct TetrahedronState {
  double strain, volume, von_mises;
};

/// Elastic bodies with a smooth surface: corotated tetrahedra under projective dynamics, E = s v |G
/// - R|² with a second Lamé parameter for Poisson's ratio, and fibres (Fratarcangeli et al. 2018,
/// "Parallel iterative solvers for real-time elastic deformations"), which carry a surface of
/// free-form patches or any other.
class PatchModel final : public Model {
 public:
  struct Material {
    ElasticMaterial elastic;
    bool averaged = false;         ///< strains of edges and vertices (averaged_tetrahedra.h)
    double damping = 0.0;          ///< time of the viscosity [s]; 0: none
    double fiber_stiffness = 0.0;  ///< along the fibres, besides `elastic` [Pa]; 0: no fibres
    Eigen::Vector3d fiber_direction = Eigen::Vector3d::UnitX();  ///< in the rest frame; any length
  };

  /// `geometry` needs tetrahedra. Throws InputError for a mesh or a material out of range.
  PatchModel(const BodyGeometry& geometry, const Material& material);

  std::string_view name() const override { return "patch"; }
  bool is_solid() const override { return true; }
  System& system() override { return system_; }
  const System& system() const override { return system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  const EmbeddedPoints* surface_points() const override { return &surface_; }
  const EmbeddedPoints* contact_points() const override { return &contact_; }
  const TetrahedralMesh* tetrahedra() const override { return &rest_; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  /// Means over a vertex's tetrahedra: `strain`, the largest principal one by size; `volume`, over
  /// the one at rest; `von_mises` [Pa].
  std::map<std::string, Eigen::VectorXd> point_fields() const override;
  bool join(Model& other) override;
  StepPlan plan_step(double dt, StepReport& report) override;
  Eigen::Matrix3Xf particle_colors() const override;
  Eigen::Matrix3Xf surface_colors() const override;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<PatchModel>(this, type); }

 private:
  struct Part {
    TetrahedralMesh rest;
    Material material;
    int first;  // particle
  };
  void add_elements(const Part& part);
  std::vector<TetrahedronState> states_of(const Part& part) const;

  ProjectiveSystem system_;
  std::vector<Part> parts_;
  TetrahedralMesh rest_;  // of all parts, each in its own frame
  Eigen::Matrix3Xi triangles_;
  EmbeddedPoints surface_, contact_;
  Eigen::VectorXd areas_;
  Eigen::Matrix3Xf particle_colors_, surface_colors_;  // of joined parts; none: all are `color`
};

ModelRegistry::Entry patch_entry();

}  // namespace pliant
