#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/models/viscoelastic/anisotropic_kernels.h"
#include "pliant/models/viscoelastic/block_polygons.h"
#include "pliant/models/viscoelastic/surface_blocks.h"
#include "pliant/models/viscoelastic/surface_device.h"

namespace pliant {

/// How a surface is drawn around particles.
struct SurfaceStyle {
  double support = 1.0;      ///< of a round kernel [m]
  int detail = 2;            ///< marching cubes along it, >= 2
  bool anisotropic = false;  ///< kernels follow the surface: smoother and slower
};

/// A closed surface around particles: marching cubes of their colour field Σ V W (Müller et al.
/// 2003) at one half, where a flat boundary truly is. Only cubes near particles at the boundary are
/// visited.
class ParticleSurface {
 public:
  void update(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& volumes, const SurfaceStyle& style);

  const TriangleMesh& mesh() const { return mesh_; }
  /// What a field of the particles is at the vertices.
  Eigen::VectorXd interpolate(const Eigen::VectorXd& field) const;
  /// The same for several at once, a row each.
  Eigen::MatrixXd interpolate_rows(const Eigen::MatrixXd& fields) const;
  /// The positions that it was made for.
  const Eigen::Matrix3Xd& positions() const { return x_; }

  /// Surfaces of round kernels are made there from now on; null: by itself.
  void set_device(std::unique_ptr<SurfaceDevice> device) { device_ = std::move(device); }
  bool has_device() const { return device_ != nullptr; }
  /// Why the device was given up, once; empty: it was not.
  std::string take_device_failure() { return std::exchange(device_failure_, {}); }

 private:
  /// False where the device cannot.
  bool make_on_device();
  void make();
  void find_plain_weights();
  void weigh_particles();
  void find_blocks();
  template <class Nearby, class Kernels>
  void fill_blocks(const Kernels& kernels);

  Eigen::Matrix3Xd x_;
  Eigen::VectorXd volumes_;
  SurfaceStyle style_;
  NeighborLists cells_;            // as large as kernels reach
  Eigen::VectorXf plain_weights_;  // V W(0), by rank
  Eigen::VectorXf weights_;        // what they count for in the field, by rank
  std::vector<char> at_boundary_;  // cells that hold a particle at the boundary
  SurfaceBlocks blocks_;
  std::vector<float> values_;  // at the nodes, block by block
  AnisotropicKernels anisotropic_;
  BlockPolygons polygons_;
  std::unique_ptr<SurfaceDevice> device_;
  std::string device_failure_;
  std::vector<Eigen::Vector3d> device_vertices_;
  std::vector<Eigen::Vector3i> device_triangles_;
  TriangleMesh mesh_;
};

}  // namespace pliant
