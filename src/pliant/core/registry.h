#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/math/error.h"

namespace pliant {

/// Named factories of one kind ("solver", "effect", "model"). `Args` is what a factory needs
/// besides its parameters.
template <class Product, class... Args>
class Registry {
 public:
  struct Entry {
    std::string name;
    std::string description;  ///< one line
    std::vector<ParameterSpec> parameters;
    std::vector<std::string> models;  ///< the models it works for
    std::function<std::unique_ptr<Product>(const Parameters&, Args...)> make;
    /// Of what acts between bodies: what a scene may say of two of them alone (BodyPairs).
    std::vector<ParameterSpec> pair_parameters = {};
  };

  explicit Registry(std::string kind) : kind_(std::move(kind)) {}

  void add(Entry entry) { entries_.push_back(std::move(entry)); }
  const std::vector<Entry>& entries() const { return entries_; }
  const std::string& kind() const { return kind_; }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) names.push_back(entry.name);
    return names;
  }

  /// Names of those that work for `model`.
  std::vector<std::string> names_for(const std::string& model) const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) {
      for (const std::string& accepted : entry.models) {
        if (accepted == model) names.push_back(entry.name);
      }
    }
    return names;
  }

  /// Throws InputError with the allowed names and the nearest one.
  const Entry& find(const std::string& name) const {
    for (const Entry& entry : entries_) {
      if (entry.name == name) return entry;
    }
    throw InputError(unknown_name_message(kind_, name, names()));
  }

  /// As find(); throws InputError also when `name` does not work for `model`.
  const Entry& find_for(const std::string& name, const std::string& model) const {
    const Entry& entry = find(name);
    for (const std::string& accepted : entry.models) {
      if (accepted == model) return entry;
    }
    std::string message =
        kind_ + " '" + name + "' does not work for model '" + model + "'; these do:";
    for (const std::string& suitable : names_for(model)) message += " " + suitable;
    throw InputError(message);
  }

 private:
  std::string kind_;
  std::vector<Entry> entries_;
};

}  // namespace pliant
