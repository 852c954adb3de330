#include "pliant/solvers/linear/projective_matrix.h"

#include <vector>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024;

/// Collects entries between particles that are free.
class FreeEntries final : public SystemMatrix {
 public:
  explicit FreeEntries(const Particles& particles) : particles_(particles) {}
  void add(int row, int column, double stiffness) override {
    if (particles_.is_fixed(row) || particles_.is_fixed(column)) return;
    entries_.emplace_back(row, column, stiffness);
  }
  std::vector<Eigen::Triplet<double>>& entries() { return entries_; }

 private:
  const Particles& particles_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

SparseRows projective_matrix(const ProjectiveSystem& system, double dt) {
  const Particles& particles = system.particles;
  FreeEntries collected(particles);
  for (const auto& set : system.elements) set->add_to_system(collected);
  auto& entries = collected.entries();
  for (int i = 0; i < particles.size(); ++i) {
    entries.emplace_back(i, i, particles.is_fixed(i) ? 1.0 : particles.mass[i] / (dt * dt));
  }
  SparseRows a(particles.size(), particles.size());
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

void multiply(const SparseRows& a, const Positions& x, Positions& y) {
  const int* begins = a.outerIndexPtr();
  const int* columns = a.innerIndexPtr();
  const double* values = a.valuePtr();
  y.resize(3, x.cols());
  parallel_for(0, static_cast<int>(x.cols()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int e = begins[i]; e < begins[i + 1]; ++e) sum += values[e] * x.col(columns[e]);
      y.col(i) = sum;
    }
  });
}

Eigen::VectorXd free_mobility(const Eigen::VectorXd& diagonal, const Particles& particles) {
  Eigen::VectorXd mobility = diagonal.cwiseInverse();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) mobility[i] = 0.0;
  }
  return mobility;
}

}  // namespace pliant
