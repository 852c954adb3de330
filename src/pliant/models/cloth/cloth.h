#pragma once

#include "pliant/core/body/model.h"
#include "pliant/core/body/wettable.h"

namespace pliant {

/// Cloth of point masses and springs (Yamada 2013, section 3.1), in SI units: areal density and
/// stiffness per width instead of hand-set spring constants, and bending. `Shear::kCells` has cells
/// in place of the springs along the diagonals, which stiffen stretch too: then a strip of it
/// measures as its material says. On a mesh that is no grid triangles strain along warp and weft.
class ClothModel final : public Model, public Wettable {
 public:
  enum class Shear { kCells, kSprings };
  struct Material {
    double areal_density = 0.15;                      ///< [kg/m²]
    double stretch_warp = 500.0;                      ///< [N/m]
    double stretch_weft = 500.0;                      ///< [N/m]
    double shear = 50.0;                              ///< [N/m]
    double bending_warp = 1e-5;                       ///< of what bends along warp [N m]
    double bending_weft = 1e-5;                       ///< [N m]
    Eigen::Vector3d warp = Eigen::Vector3d::UnitX();  ///< of a mesh: direction at rest
    Shear grid_shear = Shear::kSprings;               ///< what shears on a grid
    bool has_plates = false;                          ///< of a mesh: plates bend, not hinges
    int diagonals = 2;                                ///< of kSprings: a cell's springs, 1 or 2
    double damping = 0.0;                             ///< time of the viscosity, 0: none [s]
  };

  /// Throws InputError for a mesh that validate() refuses.
  ClothModel(const BodyGeometry& geometry, const Material& material);

  std::string_view name() const override { return "cloth"; }
  System& system() override { return system_; }
  const System& system() const override { return system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  /// `stretch`: mean strain along warp and weft at a vertex; `wetness`, where it may get wet.
  std::map<std::string, Eigen::VectorXd> point_fields() const override;
  /// Wet cloth is darker (Lekner and Dorf 1988: water lets light go further into it).
  Eigen::Matrix3Xf particle_colors() const override;
  Eigen::Matrix3Xf surface_colors() const override { return particle_colors(); }
  bool acts_around_steps() const override { return masses_changed; }
  StepPlan plan_step(double dt, StepReport& report) override;

  void show_wetness(const Eigen::VectorXd* wetness) override { wetness_ = wetness; }
  void set_mass(int particle, double mass) override;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<Wettable>(this, type); }

 private:
  void add_grid(const GridOptions& grid, const Material& material);
  void add_membrane(const TriangleMesh& mesh, const Material& material);
  void add_bending(const BodyGeometry& geometry, const Material& material);

  ProjectiveSystem system_;
  Eigen::Matrix3Xi triangles_;
  Eigen::VectorXd areas_;
  const Eigen::VectorXd* wetness_ = nullptr;  // null: no effect makes it wet
};

ModelRegistry::Entry cloth_entry();

}  // namespace pliant
