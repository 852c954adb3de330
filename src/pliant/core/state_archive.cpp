#include "pliant/core/state_archive.h"

#include <limits>

namespace pliant {

double StateArchive::read() {
  return next_ < values_.size() ? values_[next_++] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace pliant
