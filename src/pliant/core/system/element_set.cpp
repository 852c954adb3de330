#include "pliant/core/system/element_set.h"

namespace pliant {
namespace {

// Particles whose entries beside the diagonal are written out: their square counts. Without these
// the matrix is larger, as one may be that bounds the curvature of energies from above.
constexpr std::size_t kMostDense = 2048;

class EntryCount final : public SystemMatrix {
 public:
  void add(int, int, double) override { ++entries; }
  long entries = 0;
};

}  // namespace

void SystemMatrix::add_shared(const SharedEntries& shared) {
  for (const SharedEntries::Member& row : shared.members) {
    add(row.particle, row.particle, shared.stiffness * row.mass);
    if (shared.members.size() > kMostDense) continue;
    for (const SharedEntries::Member& column : shared.members) {
      // The product first, so that the matrix is symmetric to the bit.
      add(row.particle, column.particle,
          -(row.mass * column.mass) * (shared.stiffness / shared.mass));
    }
  }
}

void StiffnessMatrix::add_shared(const SharedStiffness& shared) {
  // Kept, so that it allocates nothing once it is warm.
  static thread_local std::vector<SharedStiffness::Pulls> pulls;
  pulls.clear();
  for (const SharedStiffness::Member& member : shared.members) {
    pulls.push_back(shared.pulls(member));
  }
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    const SharedStiffness::Member& row = shared.members[i];
    for (std::size_t j = 0; j < pulls.size(); ++j) {
      const double own = i == j ? row.own : 0.0;
      add(row.particle, shared.members[j].particle,
          SharedStiffness::block(pulls[i], pulls[j], own));
    }
  }
}

double ElementSet::work() const {
  EntryCount count;
  add_to_system(count);
  return static_cast<double>(count.entries);
}

}  // namespace pliant
