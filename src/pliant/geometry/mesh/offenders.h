#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "pliant/math/error.h"

namespace pliant {

/// Counts what is wrong with the parts of a mesh and remembers the first few for the message.
class Offenders {
 public:
  void add(int index) {
    if (++count_ <= kShown) first_.push_back(index);
  }
  bool empty() const { return count_ == 0; }
  /// "7 <what>: 0, 3, 5, 6, 8, ..."; "" when there are none.
  std::string text(const std::string& what) const {
    if (count_ == 0) return "";
    return fmt::format("{} {}: {}{}", count_, what, fmt::join(first_, ", "),
                       count_ > kShown ? ", ..." : "");
  }
  /// Throws InputError "<where>: <text>" when there are any.
  void refuse(const std::string& where, const std::string& what) const {
    if (count_ > 0) throw InputError(where + ": " + text(what));
  }

 private:
  static constexpr int kShown = 5;
  int count_ = 0;
  std::vector<int> first_;
};

}  // namespace pliant
