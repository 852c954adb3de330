#pragma once

#include <string>
#include <vector>

namespace pliant {

struct ElementKind {
  std::string name;
  std::string description;
};

/// Every kind of element set.
const std::vector<ElementKind>& element_kinds();

}  // namespace pliant
