#include "pliant/solvers/checks/rigid_turns.h"

#include <Eigen/Geometry>

#include "pliant/math/rotation_eigen.h"
#include "pliant/solvers/components/rigid_clusters.h"

namespace pliant {

void RigidTurns::prepare(const ProjectiveSystem& system) {
  bodies_.clear();
  for_each_cluster(system, [this](const SharedEntries& cluster) {
    if (!is_rigid(cluster)) return;
    Body body;
    for (const auto& member : cluster.members) {
      body.members.push_back({member.particle, member.mass});
    }
    bodies_.push_back(std::move(body));
  });
}

Eigen::Vector3d RigidTurns::mean(const Body& body, const Eigen::Matrix3Xd& d) {
  double mass = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Member& member : body.members) {
    mass += member.mass;
    sum += member.mass * d.col(member.particle);
  }
  return sum / mass;
}

void RigidTurns::find(const Particles& particles, double steps) {
  for (Body& body : bodies_) {
    const Eigen::Vector3d before = mean(body, particles.x_start), now = mean(body, particles.x);
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (const Member& member : body.members) {
      const Eigen::Vector3d to = particles.x.col(member.particle) - now;
      const Eigen::Vector3d from = particles.x_start.col(member.particle) - before;
      moment += member.mass * to * from.transpose();
    }
    const Eigen::AngleAxisd turn(nearest_rotation(moment));
    body.turn = Eigen::AngleAxisd(steps * turn.angle(), turn.axis()).toRotationMatrix();
  }
}

void RigidTurns::apply(Eigen::Matrix3Xd& d) const {
  for (const Body& body : bodies_) {
    const Eigen::Vector3d center = mean(body, d);
    for (const Member& member : body.members) {
      d.col(member.particle) = center + body.turn * (d.col(member.particle) - center);
    }
  }
}

}  // namespace pliant
