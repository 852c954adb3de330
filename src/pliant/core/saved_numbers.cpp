#include "pliant/core/saved_numbers.h"

#include <limits>

namespace pliant {

double SavedNumbers::read() {
  return next_ < values_.size() ? values_[next_++] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace pliant
