#include "pliant/solvers/linear/projective_product.h"

#include "pliant/solvers/linear/free_entries.h"

namespace pliant {
namespace {

// Fewer particles have as few entries by themselves.
constexpr std::size_t kFewParticles = 8;

/// Entries between free particles, but for those of clusters.
class EntriesAndClusters final : public FreeEntries {
 public:
  EntriesAndClusters(const Particles& particles, std::vector<SharedEntries>& clusters)
      : FreeEntries(particles), clusters_(clusters) {}
  void add_shared(const SharedEntries& shared) override {
    if (shared.members.size() <= kFewParticles) {
      FreeEntries::add_shared(shared);
      return;
    }
    clusters_.push_back({{}, shared.mass, shared.stiffness});
    for (const SharedEntries::Member& member : shared.members) {
      if (!particles().is_fixed(member.particle)) clusters_.back().members.push_back(member);
    }
  }

 private:
  std::vector<SharedEntries>& clusters_;
};

}  // namespace

void ProjectiveProduct::assemble(const ProjectiveSystem& system, double dt) {
  shared_.clear();
  EntriesAndClusters collected(system.particles, shared_);
  entries_ = collected.matrix(system, dt);
  diagonal_ = entries_.diagonal();
  for (const SharedEntries& cluster : shared_) {
    for (const SharedEntries::Member& m : cluster.members) {
      diagonal_[m.particle] += cluster.stiffness * m.mass * (1.0 - m.mass / cluster.mass);
    }
  }
}

Eigen::VectorXd ProjectiveProduct::absolute_row_sums() const {
  Eigen::VectorXd sums = pliant::absolute_row_sums(entries_);
  for (const SharedEntries& cluster : shared_) {
    double mass = 0.0;
    for (const SharedEntries::Member& m : cluster.members) mass += m.mass;
    for (const SharedEntries::Member& m : cluster.members) {
      const double others = (mass - m.mass) / cluster.mass;
      sums[m.particle] += cluster.stiffness * m.mass * (1.0 - m.mass / cluster.mass + others);
    }
  }
  return sums;
}

void ProjectiveProduct::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  y = entries_ * x;
  for (const SharedEntries& cluster : shared_) {
    double sum = 0.0;
    for (const SharedEntries::Member& m : cluster.members) sum += m.mass * x[m.particle];
    const double center = sum / cluster.mass;
    for (const SharedEntries::Member& m : cluster.members) {
      y[m.particle] += cluster.stiffness * m.mass * (x[m.particle] - center);
    }
  }
}

}  // namespace pliant
