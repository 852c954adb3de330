#include "pliant/scene/robot/urdf_elements.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/source_place.h"

namespace pliant {
namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

/// An attribute of an element. `count` numbers; 0: a text.
struct AttributeRule {
  const char* name;
  int count;
  bool is_required;
  const char* meaning;
};

struct ElementRule {
  std::vector<AttributeRule> attributes;
  std::vector<std::string> children;
};

/// What http://wiki.ros.org/urdf/XML says. Elements that are not here are left to whom they are
/// for.
const std::map<std::string, ElementRule>& element_rules() {
  static const std::map<std::string, ElementRule> rules = {
      {"link", {{{"name", 0, true, "its name"}}, {"inertial", "visual", "collision"}}},
      {"joint",
       {{{"name", 0, true, "its name"},
         {"type", 0, true, "fixed, revolute, continuous, prismatic, floating or planar"}},
        {"parent", "child", "origin", "axis", "limit", "mimic", "dynamics", "calibration",
         "safety_controller"}}},
      {"visual", {{{"name", 0, false, ""}}, {"origin", "geometry", "material"}}},
      {"collision", {{{"name", 0, false, ""}}, {"origin", "geometry"}}},
      {"inertial", {{}, {"origin", "mass", "inertia"}}},
      {"geometry", {{}, {"box", "sphere", "cylinder", "mesh"}}},
      {"origin",
       {{{"xyz", 3, false, "x, y, z in m"}, {"rpy", 3, false, "roll, pitch, yaw in rad"}}, {}}},
      {"box", {{{"size", 3, true, "extents in m"}}, {}}},
      {"sphere", {{{"radius", 1, true, "in m"}}, {}}},
      {"cylinder", {{{"radius", 1, true, "in m"}, {"length", 1, true, "in m"}}, {}}},
      {"mesh",
       {{{"filename", 0, true, "package://NAME/FILE or a path"},
         {"scale", 3, false, "factors along x, y, z"}},
        {}}},
      {"material", {{{"name", 0, true, "its name"}}, {"color", "texture"}}},
      {"color", {{{"rgba", 4, true, "red, green, blue, alpha from 0 to 1"}}, {}}},
      {"texture", {{{"filename", 0, false, "a path"}}, {}}},
      {"mass", {{{"value", 1, true, "in kg"}}, {}}},
      {"inertia",
       {{{"ixx", 1, true, "in kg m²"},
         {"ixy", 1, true, "in kg m²"},
         {"ixz", 1, true, "in kg m²"},
         {"iyy", 1, true, "in kg m²"},
         {"iyz", 1, true, "in kg m²"},
         {"izz", 1, true, "in kg m²"}},
        {}}},
      {"parent", {{{"link", 0, true, "the name of a link"}}, {}}},
      {"child", {{{"link", 0, true, "the name of a link"}}, {}}},
      {"axis", {{{"xyz", 3, true, "a direction"}}, {}}},
      {"limit",
       {{{"lower", 1, false, "in m or rad"},
         {"upper", 1, false, "in m or rad"},
         {"velocity", 1, true, "in m/s or rad/s"},
         {"effort", 1, true, "in N or N m"}},
        {}}},
      {"mimic",
       {{{"joint", 0, true, "the name of a joint"},
         {"multiplier", 1, false, "1 without"},
         {"offset", 1, false, "in m or rad"}},
        {}}},
      {"dynamics", {{{"damping", 1, false, ""}, {"friction", 1, false, ""}}, {}}},
      {"calibration",
       {{{"rising", 1, false, "in m or rad"}, {"falling", 1, false, "in m or rad"}}, {}}},
      {"safety_controller",
       {{{"k_velocity", 1, true, ""},
         {"k_position", 1, false, ""},
         {"soft_lower_limit", 1, false, "in m or rad"},
         {"soft_upper_limit", 1, false, "in m or rad"}},
        {}}},
  };
  return rules;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string count_text(int count) {
  return count == 1 ? "one number" : fmt::format("{} numbers", count);
}

class ElementChecker {
 public:
  ElementChecker(std::string file, std::string owner, std::vector<std::string>& warnings)
      : file_(std::move(file)), owner_(std::move(owner)), warnings_(warnings) {}

  void check(const XMLElement& element) {
    const auto found = element_rules().find(element.Name());
    if (found == element_rules().end()) return;
    const ElementRule& rule = found->second;
    for (const AttributeRule& attribute : rule.attributes) check(element, attribute);
    warn_of_attributes(element, rule);
    for (auto child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (!is_known(child->Name(), rule.children)) {
        warn_of_child(element, *child, rule);
        continue;
      }
      check(*child);
    }
  }

 private:
  static bool is_known(const std::string& name, const std::vector<std::string>& names) {
    for (const std::string& known : names) {
      if (known == name) return true;
    }
    return false;
  }

  std::string begin(const XMLElement& element) const {
    return fmt::format("{}: <{}> of {}", SourcePlace{file_, element.GetLineNum()}.text(),
                       element.Name(), owner_);
  }

  void check(const XMLElement& element, const AttributeRule& rule) const {
    const char* text = element.Attribute(rule.name);
    if (text == nullptr) {
      if (!rule.is_required) return;
      throw InputError(fmt::format("{} has no {}: write {}=\"...\", {}", begin(element), rule.name,
                                   rule.name, rule.meaning));
    }
    if (rule.count == 0) {
      // Exporters write materials without a name.
      if (*text == '\0' && rule.is_required && std::string(element.Name()) != "material") {
        throw InputError(
            fmt::format("{} has an empty {}: give {}", begin(element), rule.name, rule.meaning));
      }
      return;
    }
    const std::vector<std::string> words = split(text);
    if (static_cast<int>(words.size()) != rule.count) {
      throw InputError(fmt::format("{} has {}=\"{}\", but must have {} there, {}", begin(element),
                                   rule.name, text, count_text(rule.count), rule.meaning));
    }
    for (const std::string& word : words) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (*end == '\0' && std::isfinite(value)) continue;
      const bool has_unit = end != word.c_str() && *end != '\0';
      throw InputError(fmt::format("{} has {}=\"{}\", but '{}' is no finite number{}",
                                   begin(element), rule.name, text, word,
                                   has_unit ? "; units are not written in URDF: m, rad, kg" : ""));
    }
  }

  void warn_of_attributes(const XMLElement& element, const ElementRule& rule) {
    std::vector<std::string> names;
    for (const AttributeRule& known : rule.attributes) names.emplace_back(known.name);
    for (const XMLAttribute* given = element.FirstAttribute(); given != nullptr;
         given = given->Next()) {
      if (is_known(given->Name(), names)) continue;
      const std::string meant = nearest_name(given->Name(), names);
      if (meant.empty()) continue;
      warnings_.push_back(
          fmt::format("{} has '{}', which URDF does not know and which does "
                      "nothing; did you mean '{}'?",
                      begin(element), given->Name(), meant));
    }
  }

  void warn_of_child(const XMLElement& element, const XMLElement& child, const ElementRule& rule) {
    const std::string meant = nearest_name(child.Name(), rule.children);
    if (std::string(element.Name()) == "geometry") {
      throw InputError(fmt::format(
          "{}: <geometry> holds <{}>, but must hold one of box, sphere, "
          "cylinder, mesh{}",
          begin(child), child.Name(), meant.empty() ? "" : "; did you mean '" + meant + "'?"));
    }
    if (meant.empty()) return;
    warnings_.push_back(
        fmt::format("{} is left out, since URDF does not know it in <{}>; did you mean <{}>?",
                    begin(child), element.Name(), meant));
  }

  std::string file_, owner_;
  std::vector<std::string>& warnings_;
};

}  // namespace

void check_urdf_elements(const XMLElement& element, const std::string& file,
                         const std::string& owner, std::vector<std::string>& warnings) {
  ElementChecker(file, owner, warnings).check(element);
}

}  // namespace pliant
