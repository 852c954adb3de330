#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "pliant/core/body/held_vertex.h"
#include "pliant/core/body/particles.h"
#include "pliant/core/state_archive.h"
#include "pliant/core/system/shared_stiffness.h"
#include "pliant/math/offers.h"

namespace pliant {

/// Receives the entries of a matrix whose rows and columns are particles (each entry stands for
/// itself times the 3x3 identity).
class SystemMatrix {
 public:
  virtual ~SystemMatrix() = default;
  virtual void add(int row, int column, double stiffness) = 0;  ///< [N/m]
  /// add() of all entries of `shared`, those beside the diagonal only where they are not very many;
  /// a matrix that needs no single ones may take less time.
  virtual void add_shared(const SharedEntries& shared);
};

/// Receives 3x3 blocks of a matrix whose rows and columns are particles.
class StiffnessMatrix {
 public:
  virtual ~StiffnessMatrix() = default;
  virtual void add(int row, int column, const Eigen::Matrix3d& block) = 0;  ///< [N/m]
  /// add() of `stiffness` [N/m] times the identity; a matrix may keep the scalar alone.
  virtual void add_isotropic(int row, int column, double stiffness) {
    add(row, column, stiffness * Eigen::Matrix3d::Identity());
  }
  /// add() of all blocks of `shared`; a matrix may keep its few motions in their place.
  virtual void add_shared(const SharedStiffness& shared);
};

/// Absolute row sums: a diagonal that bounds the matrix, A <= diag(row_sums), by Gershgorin.
class AbsoluteRowSums final : public SystemMatrix {
 public:
  explicit AbsoluteRowSums(int particles) : sums_(Eigen::VectorXd::Zero(particles)) {}
  void add(int row, int, double stiffness) override { sums_[row] += std::abs(stiffness); }
  const Eigen::VectorXd& sums() const { return sums_; }  ///< [N/m]

 private:
  Eigen::VectorXd sums_;
};

/// Name of the element sets that damp.
constexpr std::string_view kMaterialDamping = "material_damping";

enum class Definiteness { kExact, kProjected };

class ElementVisitor;

/// Many elements of one kind; loops inside, no virtual call per element. Elements are grouped in
/// colours that share no particle, so that every loop is the same for any number of threads.
class ElementSet : public Offers {
 public:
  virtual std::string_view name() const = 0;
  virtual int size() const = 0;

  virtual double energy(const Positions& x) const = 0;  ///< [J]
  /// f += -dE/dx. It is also the local step of a projective solver: w S^T (p - S x), with each
  /// element's projection p of its own particles S x and its weight w.
  virtual void add_forces(const Positions& x, Forces& f) const = 0;  ///< [N]
  /// The constant matrix of projective dynamics, sum of w S^T S; bounds the stiffness from above.
  virtual void add_to_system(SystemMatrix& a) const = 0;
  /// What it costs to find the forces of all elements, in visits of an entry of that matrix.
  virtual double work() const;
  /// What an element costs beside those of other kinds.
  enum class Cost { kSpring, kCell, kHinge, kOther };
  virtual Cost cost_of_element() const { return Cost::kOther; }
  /// Whether its elements fill a body's inside.
  virtual bool is_solid() const { return false; }
  /// Whether its forces, which always add up to nothing, may have a torque: it turns particles that
  /// have an orientation.
  virtual bool has_torque() const { return false; }
  /// Shows itself as what it is; false, and nothing shown, for kinds that visitors do not know.
  virtual bool accept(ElementVisitor& /*visitor*/) const { return false; }
  /// Adds d²E/dx². With kProjected every element's own part is made positive semi-definite.
  virtual void add_stiffness(const Positions& x, Definiteness definiteness,
                             StiffnessMatrix& k) const = 0;
  /// Appends the springs by which its elements hold particles at places; most kinds have none.
  virtual void add_held(std::vector<HeldVertex>& /*held*/) const {}
  /// Forgets what it kept from earlier steps to begin the next one (rotations).
  virtual void reset() {}
  /// What it keeps from one step to the next, and back.
  virtual void save(StateArchive& /*numbers*/) const {}
  virtual void load(StateArchive& /*numbers*/) {}

  /// Whether its energy is none that is stored: that of a set that damps is half of what its forces
  /// dissipate in an effective step, which its matrices and forces depend on.
  virtual bool is_viscous() const { return false; }
  /// The effective step changed [s].
  virtual void prepare(double /*step*/) {}
  /// Whether what it holds particles to moves in the running step, to where it is at its end.
  virtual bool is_moving() const { return false; }
  /// A step begins, from `x_start` and what inertia goes on from.
  virtual void begin_step(const Particles& /*particles*/) {}
  /// Appends sets that damp its strains with a viscosity `time` [s] times its stiffness, where
  /// there are any for its kind.
  virtual void add_damping(double /*time*/,
                           std::vector<std::unique_ptr<ElementSet>>& /*sets*/) const {}

  /// Compliance form (XPBD): forgets the multipliers of the last step.
  virtual void reset_multipliers() = 0;
  /// Compliance form: one Gauss-Seidel sweep over all elements.
  virtual void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) = 0;
};

}  // namespace pliant
