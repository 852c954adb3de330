#pragma once

#include <functional>
#include <string>

namespace pliant {

/// What a piece of work may take that reads a file with a library which trusts it.
struct ChildLimits {
  double memory = 4e9;  ///< beyond what the process has already [bytes]
  int seconds = 120;    ///< of processor time, and twice that by the clock
};

/// What `work` returns, done by a child of this process: where the file makes the library crash,
/// allocate without end or never return, the child is gone and not the program. It writes no file,
/// and what it changes in memory is lost. An InputError of `work` is thrown here; so is one that
/// begins with `what` (as "mesh 'a.dae'") where the child did not come to its end, and says why.
std::string in_child_process(const ChildLimits& limits, const std::string& what,
                             const std::function<std::string()>& work);

}  // namespace pliant
