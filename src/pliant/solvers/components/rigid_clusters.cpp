#include "pliant/solvers/components/rigid_clusters.h"

namespace pliant {
namespace {

// Clusters of no more particles may be rigid bodies.
constexpr std::size_t kFewParticles = 8;
// Their stiffness, the one that the model `rigid` gives them [1/s²].
constexpr double kRigidStiffness = 1e7;

class ClusterProbe final : public SystemMatrix {
 public:
  explicit ClusterProbe(const std::function<void(const SharedEntries&)>& see) : see_(see) {}
  void add(int, int, double) override { has_others_ = true; }
  void add_shared(const SharedEntries& shared) override { see_(shared); }
  bool has_others() const { return has_others_; }

 private:
  const std::function<void(const SharedEntries&)>& see_;
  bool has_others_ = false;
};

}  // namespace

void for_each_cluster(const ProjectiveSystem& system,
                      const std::function<void(const SharedEntries&)>& see) {
  ClusterProbe probe(see);
  for (const auto& set : system.elements) set->add_to_system(probe);
}

bool is_rigid(const SharedEntries& cluster) {
  return cluster.members.size() <= kFewParticles && cluster.stiffness >= kRigidStiffness;
}

bool is_made_of_rigid_bodies(const ProjectiveSystem& system) {
  bool are_there = false, are_rigid = true;
  const std::function<void(const SharedEntries&)> look = [&](const SharedEntries& cluster) {
    are_there = true;
    are_rigid = are_rigid && is_rigid(cluster);
  };
  ClusterProbe probe(look);
  for (const auto& set : system.elements) set->add_to_system(probe);
  return are_there && are_rigid && !probe.has_others();
}

void let_rigid_bodies_move(const ProjectiveSystem& system, const Eigen::VectorXd& inertia,
                           Eigen::VectorXd& mobility) {
  for_each_cluster(system, [&](const SharedEntries& cluster) {
    if (!is_rigid(cluster)) return;
    for (const auto& member : cluster.members) {
      const int i = member.particle;
      if (!system.particles.is_fixed(i)) mobility[i] = 1.0 / inertia[i];
    }
  });
}

}  // namespace pliant
