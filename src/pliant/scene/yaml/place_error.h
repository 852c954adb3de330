#pragma once

#include <string>

#include "pliant/math/error.h"

namespace pliant {

/// Calls `work`; what it refuses with an InputError then begins with `where`.
template <class Work>
decltype(auto) with_place(const std::string& where, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.compare(0, where.size(), where) == 0) throw;
    throw InputError(where + ": " + message);
  }
}

}  // namespace pliant
