#include "pliant/core/system/element_set.h"

namespace pliant {
namespace {

class EntryCount final : public SystemMatrix {
 public:
  void add(int, int, double) override { ++entries; }
  long entries = 0;
};

}  // namespace

double ElementSet::work() const {
  EntryCount count;
  add_to_system(count);
  return static_cast<double>(count.entries);
}

}  // namespace pliant
