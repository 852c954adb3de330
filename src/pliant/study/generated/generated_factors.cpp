#include "pliant/study/generated/generated_factors.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"

namespace pliant {
namespace {

std::vector<std::string> solver_values() {
  std::vector<std::string> values = {"default"};
  for (const std::string& name : all_solvers().names()) {
    if (std::find(values.begin(), values.end(), name) == values.end()) values.push_back(name);
  }
  return values;
}

bool moves(const std::string& solver, const std::string& model) {
  const std::vector<std::string> names = all_solvers().names_for(model);
  return std::find(names.begin(), names.end(), solver) != names.end();
}

}  // namespace

const std::array<SceneFactor, kFactorCount>& scene_factors() {
  static const std::array<SceneFactor, kFactorCount> factors = {{
      {"model", {"cloth", "patch", "viscoelastic", "reduced", "rigid"}},
      {"solver", solver_values()},
      {"surroundings",
       {"nothing", "drift", "fall", "plane", "box", "pinned", "held", "two", "hand", "robot"}},
      {"shape", {"first", "second", "third"}},
      {"flags", {"none", "first", "second", "third"}},
      {"stiffness", {"usual", "soft", "stiff", "hard"}},
      {"iterations", {"usual", "one", "zero", "many"}},
      {"time_integration", {"default", "implicit_euler", "bdf2", "midpoint"}},
      {"start", {"rest", "stretched", "shaken", "spinning"}},
      {"effects", {"none", "damping", "first", "second", "all"}},
      {"self_contact", {"no", "yes"}},
      {"place", {"origin", "turned", "far"}},
      {"tilt", {"none", "any", "upside_down"}},
      {"step", {"usual", "short", "long"}},
      {"size", {"coarse", "fine"}},
  }};
  return factors;
}

const std::string& value_of(const SceneChoice& choice, Factor factor) {
  return scene_factors()[factor].values[static_cast<std::size_t>(choice[factor])];
}

bool go_together(Factor one, int value, Factor other, int other_value) {
  if (one > other) return go_together(other, other_value, one, value);
  const std::string& first = scene_factors()[one].values[static_cast<std::size_t>(value)];
  const std::string& second = scene_factors()[other].values[static_cast<std::size_t>(other_value)];
  if (one == kFactorModel && other == kFactorSolver)
    return second == "default" || moves(second, first);
  if (one == kFactorModel && other == kFactorSurroundings) {
    return first != "rigid" || second != "pinned";
  }
  if (other != kFactorIntegration || second == "default") return true;
  if (one == kFactorModel)
    return first != "reduced" && (first != "rigid" || second == "implicit_euler");
  if (one != kFactorSolver || first == "default") return true;
  // Reduced bodies have integrators, and these solvers a time integration of their own.
  if (!moves(first, "cloth") && !moves(first, "viscoelastic")) return false;
  return (first != "verlet" && first != "shape_matching") || second == "implicit_euler";
}

bool is_possible(const SceneChoice& choice) {
  const auto fit = [&](Factor one, Factor other) {
    return go_together(one, choice[one], other, choice[other]);
  };
  return fit(kFactorModel, kFactorSolver) && fit(kFactorModel, kFactorSurroundings) &&
         fit(kFactorModel, kFactorIntegration) && fit(kFactorSolver, kFactorIntegration);
}

std::string choice_text(const SceneChoice& choice) {
  std::string text;
  for (int f = 0; f < kFactorCount; ++f) {
    if (!text.empty()) text += ", ";
    text += scene_factors()[static_cast<std::size_t>(f)].name + ": " +
            value_of(choice, static_cast<Factor>(f));
  }
  return text;
}

SceneChoice choice_of(const std::string& text, const std::string& where) {
  std::map<std::string, std::string> given;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    const auto colon = item.find(": ");
    if (colon == std::string::npos)
      throw InputError(where + ": '" + item + "' is no 'name: value'");
    const auto begin = item.find_first_not_of(' ');
    given[item.substr(begin, colon - begin)] = item.substr(colon + 2);
  }
  SceneChoice choice{};
  for (int f = 0; f < kFactorCount; ++f) {
    const SceneFactor& factor = scene_factors()[static_cast<std::size_t>(f)];
    const auto found = given.find(factor.name);
    if (found == given.end()) throw InputError(where + ": '" + factor.name + "' is missing");
    const auto value = std::find(factor.values.begin(), factor.values.end(), found->second);
    if (value == factor.values.end()) {
      throw InputError(where + ": " +
                       unknown_name_message(factor.name, found->second, factor.values));
    }
    choice[static_cast<std::size_t>(f)] = static_cast<int>(value - factor.values.begin());
    given.erase(found);
  }
  if (!given.empty())
    throw InputError(where + ": there is no factor '" + given.begin()->first + "'");
  return choice;
}

}  // namespace pliant
