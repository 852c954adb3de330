#include "pliant/solvers/checks/rigid_bend.h"

#include "pliant/solvers/components/rigid_clusters.h"

namespace pliant {

void RigidBend::prepare(const ProjectiveSystem& system, const Components& components) {
  is_used_ = false;
  for_each_cluster(
      system, [this](const SharedEntries& cluster) { is_used_ = is_used_ || is_rigid(cluster); });
  stiffness_.setZero(is_used_ ? system.particles.size() : 0);
  if (!is_used_) return;
  for_each_cluster(system, [this](const SharedEntries& cluster) {
    if (!is_rigid(cluster)) return;
    for (const auto& member : cluster.members) {
      stiffness_[member.particle] = cluster.stiffness * member.mass;
    }
  });
  modes_.prepare(components, system.particles.mass);
}

const Positions& RigidBend::find(const PointConstraints& constraints, const Positions& x) {
  bend_.setZero(3, x.cols());
  for (const PointConstraint& constraint : constraints.all) {
    const Eigen::Vector3d force =
        constraint.normal_force * constraint.normal + constraint.friction_force;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& [particle, weight] = constraints.entries[static_cast<std::size_t>(e)];
      if (stiffness_[particle] > 0.0) bend_.col(particle) += weight * force;
    }
  }
  modes_.update(x);
  modes_.take_out(bend_);
  for (int i = 0; i < static_cast<int>(bend_.cols()); ++i) {
    // What holds a body bends it too, and nobody knows by how much.
    const bool is_bent = stiffness_[i] > 0.0 && modes_.body_of(i) >= 0;
    bend_.col(i) = is_bent ? Eigen::Vector3d(bend_.col(i) / stiffness_[i])
                           : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  return bend_;
}

void RigidBend::bend(PointConstraints& constraints, const Positions& x) {
  find(constraints, x);
  for (PointConstraint& constraint : constraints.all) {
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& [particle, weight] = constraints.entries[static_cast<std::size_t>(e)];
      u += weight * bend_.col(particle);
    }
    constraint.gap += constraint.normal.dot(u);
    constraint.slip -= constraint.owed;
  }
}

}  // namespace pliant
