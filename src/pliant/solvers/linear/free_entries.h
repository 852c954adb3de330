#pragma once

#include <vector>

#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {

/// Collects entries of the matrix of projective dynamics between particles that are free.
class FreeEntries : public SystemMatrix {
 public:
  explicit FreeEntries(const Particles& particles) : particles_(particles) {}
  void add(int row, int column, double stiffness) override {
    if (particles_.is_fixed(row) || particles_.is_fixed(column)) return;
    entries_.emplace_back(row, column, stiffness);
  }
  /// M/h² with what the elements of `system` add to it, 1 on the diagonal of a fixed particle.
  SparseRows matrix(const ProjectiveSystem& system, double dt) {
    for (const auto& set : system.elements) set->add_to_system(*this);
    for (int i = 0; i < particles_.size(); ++i) {
      entries_.emplace_back(i, i, particles_.is_fixed(i) ? 1.0 : particles_.mass[i] / (dt * dt));
    }
    SparseRows a(particles_.size(), particles_.size());
    a.setFromTriplets(entries_.begin(), entries_.end());
    return a;
  }

 protected:
  const Particles& particles() const { return particles_; }

 private:
  const Particles& particles_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace pliant
