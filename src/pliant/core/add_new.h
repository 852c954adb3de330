#pragma once

#include <algorithm>
#include <utility>

#include "pliant/core/registry.h"

namespace pliant {

/// Adds what another package brings. Throws InputError where the name is taken.
template <class Product, class... Args>
void add_new(typename Registry<Product, Args...>::Entry entry,
             Registry<Product, Args...>& registry) {
  const std::vector<std::string> names = registry.names();
  if (std::find(names.begin(), names.end(), entry.name) != names.end()) {
    throw InputError(registry.kind() + " '" + entry.name +
                     "' is there already: give the added one another name");
  }
  registry.add(std::move(entry));
}

}  // namespace pliant
