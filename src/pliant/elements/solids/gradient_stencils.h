#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Parts of a body, each with one deformation gradient that is linear in its particles,
/// G = Σₖ xₖ gₖᵀ. The gₖ of a part add up to nothing.
class GradientStencils {
 public:
  int size() const { return static_cast<int>(volumes_.size()); }
  double volume(int part) const { return volumes_[at(part)]; }  ///< at rest [m³]
  /// Entries of a part: particle() and shape() of [begin, end).
  int begin(int part) const { return begins_[at(part)]; }
  int end(int part) const { return begins_[at(part) + 1]; }
  int particle(int entry) const { return particles_[at(entry)]; }
  const Eigen::Vector3d& shape(int entry) const { return shapes_[at(entry)]; }  ///< gₖ [1/m]
  int entries() const { return static_cast<int>(particles_.size()); }

  Eigen::Matrix3d gradient(int part, const Positions& x) const;
  void add(double volume, const std::vector<int>& particles,
           const std::vector<Eigen::Vector3d>& shapes);
  void append(const GradientStencils& others);

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  std::vector<int> begins_ = {0};
  std::vector<int> particles_;
  std::vector<Eigen::Vector3d> shapes_;
  std::vector<double> volumes_;
};

/// Of a mesh whose vertex 0 is the particle `first_particle`. All throw InputError, beginning with
/// `name`, for a mesh that validate() refuses.
///
/// Its tetrahedra.
GradientStencils tetrahedron_stencils(const std::string& name, const TetrahedralMesh& rest,
                                      int first_particle = 0);
/// The mean around each edge, of its tetrahedra by volume; a tetrahedron gives a sixth of its own
/// to each of its edges (edge-based smoothed finite elements, Liu, Nguyen-Thoi and Lam 2009).
GradientStencils edge_stencils(const std::string& name, const TetrahedralMesh& rest,
                               int first_particle = 0);
/// Of tetrahedron_stencils(), the mean around each vertex, a quarter of each tetrahedron (averaged
/// nodal pressure, Bonet and Burton 1998). Particles that are `pinned` (empty: none) have none:
/// they cannot give way, and a condition on their volume would only stiffen what is clamped. The
/// other vertices of a tetrahedron share what is theirs; where all are pinned, it stays with them.
GradientStencils vertex_means(const GradientStencils& tetrahedra,
                              const std::vector<bool>& pinned = {});

}  // namespace pliant
