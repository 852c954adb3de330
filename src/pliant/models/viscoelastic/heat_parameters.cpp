#include "pliant/models/viscoelastic/heat_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pliant/effects/particles/heat.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Member = std::optional<double> HeatProperties::*;

const std::vector<std::pair<std::string, Member>>& members() {
  static const std::vector<std::pair<std::string, Member>> all = {
      {"initial_temperature", &HeatProperties::initial_temperature},
      {"melting_point", &HeatProperties::melting_point},
      {"melting_range", &HeatProperties::melting_range},
      {"latent_heat", &HeatProperties::latent_heat},
      {"capacity", &HeatProperties::capacity},
      {"conductivity", &HeatProperties::conductivity},
      {"solid_beta", &HeatProperties::solid_beta}};
  return all;
}

const ParameterSpec& spec_of_effect(const std::string& name) {
  static const std::vector<ParameterSpec> specs = heat_entry().parameters;
  return *std::find_if(specs.begin(), specs.end(),
                       [&](const ParameterSpec& spec) { return spec.name == name; });
}

}  // namespace

std::vector<ParameterSpec> heat_parameters() {
  std::vector<ParameterSpec> specs;
  for (const auto& [name, member] : members()) {
    ParameterSpec spec = spec_of_effect(name);
    spec.meaning = "of this body, for the effect heat: " + spec.meaning +
                   "; negative: as the effect says for all";
    spec.default_value = "-1";
    spec.min = -1.0;
    spec.min_is_allowed = true;
    specs.push_back(std::move(spec));
  }
  return specs;
}

HeatProperties heat_properties(const Parameters& given) {
  HeatProperties heat;
  for (const auto& [name, member] : members()) {
    const double value = given.number(name);
    if (value < 0.0) continue;
    const ParameterSpec& spec = spec_of_effect(name);
    if (value < spec.min || (value == spec.min && !spec.min_is_allowed)) {
      throw InputError(
          fmt::format("'{}' is {:g}, but must be {}, or negative for the value that "
                      "the effect 'heat' has",
                      name, value, spec.range_text()));
    }
    heat.*member = value;
  }
  return heat;
}

}  // namespace pliant
