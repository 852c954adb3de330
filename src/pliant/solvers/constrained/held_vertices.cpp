#include "pliant/solvers/constrained/held_vertices.h"

namespace pliant {

const Eigen::VectorXd& HeldVertices::settle(ProjectiveSystem& system,
                                            const Eigen::VectorXd& mobility, double dt) {
  held_.clear();
  for (const auto& set : system.elements) {
    const std::size_t before = held_.size();
    set->add_held(held_);
    if (held_.size() > before) set->relax(system.particles.inverse_mass, dt, system.particles.x);
  }
  if (held_.empty()) return mobility;
  held_mobility_ = mobility;
  for (const HeldVertex& vertex : held_) {
    double& own = held_mobility_[vertex.particle];
    own /= 1.0 + vertex.stiffness * own;
  }
  return held_mobility_;
}

}  // namespace pliant
