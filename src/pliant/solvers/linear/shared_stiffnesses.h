#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// The sum of many shared stiffnesses as a part of a matrix: its product with a vector takes time
/// as the particles of each do, not as their square.
class SharedStiffnesses {
 public:
  struct Member {
    int particle;
    Eigen::Vector4d load;
  };
  /// A particle's part of a shared stiffness.
  struct Place {
    int shared;
    Eigen::Vector4d load;
  };

  /// Begins an assembly.
  void begin_assembly(int particles);
  /// Leaves pinned particles out.
  void add(const SharedStiffness& shared, const Particles& particles);
  /// Ends it: the following know what was added.
  void finish();

  int count() const { return static_cast<int>(begins_.size()) - 1; }
  int begin(int shared) const { return begins_[static_cast<std::size_t>(shared)]; }
  int end(int shared) const { return begins_[static_cast<std::size_t>(shared) + 1]; }
  const Member& member(int number) const { return members_[static_cast<std::size_t>(number)]; }
  int members() const { return static_cast<int>(members_.size()); }
  const SharedStiffness::Pulls& pulls(int number) const {
    return pulls_[static_cast<std::size_t>(number)];
  }
  /// Σ s_i of a particle [N/m], and its block on the diagonal.
  double own(int particle) const { return own_[particle]; }
  const Eigen::Matrix3d& diagonal(int particle) const {
    return diagonals_[static_cast<std::size_t>(particle)];
  }
  /// Calls `use`(particle) for all that share a stiffness with `particle`, with repetitions and
  /// itself, stiffness by stiffness, until it returns false.
  template <class Use>
  void for_sharing(int particle, const Use& use) const;

  /// y += K v.
  void add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const;
  /// Multiplications of add_product().
  double work() const;

 private:
  int first_place(int particle) const { return places_at_[static_cast<std::size_t>(particle)]; }

  std::vector<int> begins_ = {0};  // of members
  std::vector<Member> members_;
  std::vector<SharedStiffness::Pulls> pulls_;  // of each member
  std::vector<double> moves_;
  std::vector<std::array<Eigen::Matrix3d, SharedStiffness::kTurns>> turns_;
  Eigen::VectorXd own_;
  std::vector<Eigen::Matrix3d> diagonals_;
  std::vector<int> places_at_;  // where each particle's places begin
  std::vector<Place> places_;   // of each particle, in the order of shared stiffnesses
  // Of shared stiffnesses, of the running product; and one more, which registers read into.
  mutable std::vector<Eigen::Matrix<double, 3, 4>> answers_;
};

template <class Use>
void SharedStiffnesses::for_sharing(int particle, const Use& use) const {
  if (members_.empty()) return;
  for (int p = first_place(particle); p < first_place(particle + 1); ++p) {
    const int shared = places_[static_cast<std::size_t>(p)].shared;
    for (int m = begin(shared); m < end(shared); ++m) {
      if (!use(member(m).particle)) return;
    }
  }
}

}  // namespace pliant
