#include "pliant/study/option_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "pliant/core/parameters.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kMaxCount = 1e6;
constexpr double kMaxTimeStep = 1.0;  // [s]

/// The items between commas, without the blanks around them.
std::vector<std::string> items_of(const std::string& text, const std::string& option,
                                  const std::string& example) {
  std::vector<std::string> items(1);
  for (char c : text) {
    if (c == ',') {
      items.emplace_back();
    } else if (c != ' ' && c != '\t') {
      items.back() += c;
    }
  }
  for (const std::string& item : items) {
    if (item.empty()) {
      throw InputError(
          fmt::format("{} '{}' has an empty item; write for example {}", option, text, example));
    }
  }
  return items;
}

/// `items` must be sorted.
template <class Item>
void refuse_twice(const std::vector<Item>& items, const std::string& option) {
  const auto found = std::adjacent_find(items.begin(), items.end());
  if (found != items.end()) {
    throw InputError(fmt::format("{} has {} twice; write it once", option, *found));
  }
}

}  // namespace

std::vector<std::string> parse_names(const std::string& text, const std::string& option) {
  if (text == "all") return {};
  std::vector<std::string> names = items_of(text, option, "jacobi,xpbd");
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  refuse_twice(sorted, option);
  return names;
}

std::vector<int> parse_counts(const std::string& text, const std::string& option) {
  std::vector<int> counts;
  for (const std::string& item : items_of(text, option, "1,2,4,8")) {
    const double count = parse_number(item, option);
    if (!(count >= 1.0 && count <= kMaxCount && count == std::floor(count))) {
      throw InputError(fmt::format("{} has {}, but must be whole numbers from 1 to {:.0f}", option,
                                   item, kMaxCount));
    }
    counts.push_back(static_cast<int>(count));
  }
  std::sort(counts.begin(), counts.end());
  refuse_twice(counts, option);
  return counts;
}

std::vector<double> parse_time_steps(const std::string& text, const std::string& option) {
  std::vector<double> steps;
  for (const std::string& item : items_of(text, option, "0.005,0.0025")) {
    steps.push_back(parse_number(item, option));
    if (!(steps.back() > 0.0 && steps.back() <= kMaxTimeStep)) {
      throw InputError(fmt::format("{} has {}, but a time step must be > 0 and <= {:g} s", option,
                                   item, kMaxTimeStep));
    }
  }
  std::sort(steps.begin(), steps.end(), std::greater<double>());
  refuse_twice(steps, option);
  return steps;
}

double parse_wall_time(const std::string& text, const std::string& option) {
  struct Unit {
    const char* name;
    double seconds;
  };
  constexpr std::array<Unit, 3> kUnits = {{{"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}}};
  for (const Unit& unit : kUnits) {
    const std::string name = unit.name;
    if (text.size() <= name.size() || text.substr(text.size() - name.size()) != name) continue;
    const double value = parse_number(text.substr(0, text.size() - name.size()), option);
    if (value > 0.0) return value * unit.seconds;
    throw InputError(fmt::format("{} is {}, but must be > 0, for example 16ms", option, text));
  }
  throw InputError(fmt::format(
      "{} is '{}', but must be a time with its unit: 16ms, 0.016s or 500us", option, text));
}

}  // namespace pliant
