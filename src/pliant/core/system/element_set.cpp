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
  for (const SharedStiffness::Member& row : shared.members) {
    for (const SharedStiffness::Member& column : shared.members) {
      add(row.particle, column.particle, shared.block(row, column));
    }
  }
}

double ElementSet::work() const {
  EntryCount count;
  add_to_system(count);
  return static_cast<double>(count.entries);
}

}  // namespace pliant
