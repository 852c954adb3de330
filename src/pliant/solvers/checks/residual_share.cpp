#include "pliant/solvers/checks/residual_share.h"

#include <algorithm>
#include <cmath>

#include "pliant/solvers/components/components.h"
#include "pliant/solvers/components/rigid_clusters.h"

namespace pliant {
namespace {

// The ratio up to which residuals as small as the error suffice, and by what power of it they have
// to be smaller above. Measured on solids that fall, roll and lie in a box (docs/accuracy.md): the
// square root alone makes soft ones take half as long again for errors that are small anyway.
constexpr double kSoft = 100.0, kPower = 0.75;

/// Marks the particles that elements act on, but those of rigid bodies.
class Touched final : public SystemMatrix {
 public:
  explicit Touched(int particles) : is_(static_cast<std::size_t>(particles), false) {}
  void add(int row, int /*column*/, double /*stiffness*/) override { mark(row); }
  void add_shared(const SharedEntries& shared) override {
    if (is_rigid(shared)) return;
    for (const SharedEntries::Member& member : shared.members) mark(member.particle);
  }
  bool is(int particle) const { return is_[static_cast<std::size_t>(particle)]; }

 private:
  void mark(int particle) { is_[static_cast<std::size_t>(particle)] = true; }
  std::vector<bool> is_;
};

}  // namespace

double share_of_free_solids(const ProjectiveSystem& system, const Eigen::VectorXd& diagonal,
                            const Eigen::VectorXd& inertia) {
  Touched solid(system.particles.size());
  for (const auto& set : system.elements) {
    if (set->is_solid()) set->add_to_system(solid);
  }
  const Components components = find_components(system);
  double largest = 1.0;
  for (int c = 0; c < components.count(); ++c) {
    if (components.held[static_cast<std::size_t>(c)]) continue;
    double stiffness = 0.0, mass = 0.0;
    for (int k = components.begins[static_cast<std::size_t>(c)];
         k < components.begins[static_cast<std::size_t>(c) + 1]; ++k) {
      const int i = components.members[static_cast<std::size_t>(k)];
      if (!solid.is(i)) continue;
      stiffness += diagonal[i];
      mass += inertia[i];
    }
    if (mass > 0.0) largest = std::max(largest, stiffness / mass);
  }
  return std::min(1.0, std::pow(largest / kSoft, -kPower));
}

}  // namespace pliant
