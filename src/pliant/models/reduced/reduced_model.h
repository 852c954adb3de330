#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/models/reduced/project_potential.h"
#include "pliant/models/reduced/quartic_potential.h"

namespace pliant {

/// 1/√3: where the force of a St. Venant-Kirchhoff bar under compression is largest.
constexpr double kSofteningStretch = 0.57735026918962576;

/// A reduced body, ready to be simulated: u = U q.
struct ReducedModel {
  std::string name;
  ElasticMaterial material;
  int modes = 0;            ///< linear modes that the basis was made of
  TetrahedralMesh mesh;     ///< at rest, n vertices [m]
  std::vector<bool> fixed;  ///< n
  Eigen::MatrixXd basis;  ///< U: 3n x r, x y z of one vertex after the other; 0 where fixed [kg^-½]
  QuarticPotential potential;  ///< V(q) [J], q [kg^½ m]
  /// What is drawn and touched, carried by the tetrahedra; without triangles: their boundary.
  TriangleMesh surface = {};

  int rank() const { return potential.rank(); }
  /// 3 x n positions at reduced coordinates q [m].
  Eigen::Matrix3Xd positions(const Eigen::VectorXd& q) const;
  /// Uᵀ f of 3 x n forces on vertices [N].
  Eigen::VectorXd reduced_force(const Eigen::Matrix3Xd& forces) const;
  /// The smallest principal stretch of all tetrahedra at q; below kSofteningStretch the material
  /// softens, and the body may collapse.
  double smallest_stretch(const Eigen::VectorXd& q) const;
};

enum class MassMatrix { kConsistent, kLumped };

struct ReduceOptions {
  int modes = 10;  ///< linear modes k >= 1
  int rank = 20;   ///< 1 to kMaxRank, at most k + k (k + 1)/2
  MassMatrix mass = MassMatrix::kConsistent;
};

/// Gives back what `make` computes under that name, or what it gave when the same reduction was
/// stopped before. A matrix without numbers means that it was stopped now.
using MatrixStore = std::function<Eigen::MatrixXd(const std::string& name,
                                                  const std::function<Eigen::MatrixXd()>& make)>;

/// Barbič and James 2005: linear modes, their derivatives, mass-PCA, and the potential in that
/// basis. Nothing when `progress` asks to stop; where there is a store, it has then what was
/// finished: modes and derivatives. Throws InputError for options out of their range or
/// a body that has not so many modes.
std::optional<ReducedModel> reduce(const StvkBody& body, const ReduceOptions& options,
                                   const std::string& name, const ReduceProgress& progress,
                                   const MatrixStore& store = {});

}  // namespace pliant
