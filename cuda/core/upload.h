#pragma once

#include <cstddef>

namespace pliant {

/// Copies `values` to the executor's `array`. Returns whether that had to get new memory: room for
/// more than now saves most of that later, where numbers grow from step to step.
template <class Executor, class Array, class Values>
bool upload_all(Executor& executor, Array& array, const Values& values) {
  const std::size_t count = values.size();
  const bool grows = array.size() < count;
  if (grows) array.resize(array.size() == 0 ? count : count + count / 2);
  if (count > 0) executor.upload(array, values.data(), count);
  return grows;
}

}  // namespace pliant
