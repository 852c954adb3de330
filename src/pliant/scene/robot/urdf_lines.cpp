#include "pliant/scene/robot/urdf_lines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>

#include "pliant/math/error.h"
#include "pliant/scene/robot/urdf_elements.h"
#include "pliant/scene/robot/urdf_mend.h"

namespace pliant {
namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

const std::vector<std::string>& joint_types() {
  static const std::vector<std::string> types = {"fixed",     "revolute", "continuous",
                                                 "prismatic", "floating", "planar"};
  return types;
}

void parse_xml(const std::string& text, const std::string& where, tinyxml2::XMLDocument& document) {
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  if (error == tinyxml2::XML_SUCCESS) return;
  const std::string place = SourcePlace{where, std::max(1, document.ErrorLineNum())}.text();
  if (error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) {
    throw InputError(
        fmt::format("{}: elements are nested deeper than {}", place, TINYXML2_MAX_ELEMENT_DEPTH));
  }
  if (error == tinyxml2::XML_ERROR_EMPTY_DOCUMENT) {
    throw InputError(where + ": the URDF is empty: it holds no element");
  }
  throw InputError(
      fmt::format("{}: this is not XML, and so not valid URDF: {}", place, document.ErrorStr()));
}

bool is_xacro(const XMLElement& element) {
  if (std::strncmp(element.Name(), "xacro:", 6) == 0) return true;
  for (const XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (std::strstr(a->Value(), "${") != nullptr || std::strstr(a->Value(), "$(") != nullptr) {
      return true;
    }
  }
  return false;
}

/// The first element in the file's order that xacro would expand. Nesting is bounded.
const XMLElement* find_xacro(const XMLElement& element) {
  if (is_xacro(element)) return &element;
  for (auto child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (const XMLElement* found = find_xacro(*child)) return found;
  }
  return nullptr;
}

void refuse_xacro(const XMLElement& root, const std::string& where) {
  const XMLElement* found = find_xacro(root);
  if (found == nullptr) return;
  const bool is_file = where.find('.') != std::string::npos;
  const std::string in = is_file ? where : "FILE.xacro";
  const std::string out = std::filesystem::path(in).replace_extension("").string() +
                          (std::filesystem::path(in).extension() == ".urdf" ? "_expanded" : "") +
                          ".urdf";
  throw InputError(fmt::format(
      "{}: <{}> is xacro, which has to be expanded to URDF first: `xacro {} > {}` (or `rosrun "
      "xacro xacro {} > {}`)",
      SourcePlace{where, found->GetLineNum()}.text(), found->Name(), in, out, in, out));
}

/// The elements of a robot that have a name of their own.
class UrdfIndex {
 public:
  UrdfIndex(const XMLElement& root, UrdfXml& result) : root_(root), result_(result) {}

  void check() {
    each("link", [&](const XMLElement& link) { add_link(link); });
    if (links_.empty()) {
      throw InputError(at(root_) +
                       ": the robot has no link: give at least one <link name=\"...\">");
    }
    if (links_.size() > kMaxLinks) {
      throw InputError(fmt::format("{}: the robot has {} links, but at most {} are allowed",
                                   at(root_), links_.size(), kMaxLinks));
    }
    each("joint", [&](const XMLElement& joint) { add_joint(joint); });
    check_materials();
    check_tree();
    warn_of_masses();
  }

 private:
  using Visit = std::function<void(const XMLElement&)>;

  std::string at(const XMLElement& element) const { return result_.lines.at(element.GetLineNum()); }

  void each(const char* name, const Visit& visit) const {
    for (auto e = root_.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name)) {
      visit(*e);
    }
  }

  std::string name_of(const XMLElement& element) const {
    const char* name = element.Attribute("name");
    if (name != nullptr && *name != '\0') return name;
    throw InputError(fmt::format("{}: <{}> has no name: write <{} name=\"...\">", at(element),
                                 element.Name(), element.Name()));
  }

  void refuse_twice(const XMLElement& element, const std::string& name, int first) const {
    throw InputError(
        fmt::format("{}: {} '{}' is not unique: line {} has one of that name; rename "
                    "one of them",
                    at(element), element.Name(), name, first));
  }

  void add_link(const XMLElement& element) {
    const std::string name = name_of(element);
    UrdfLines::Link link;
    link.line = element.GetLineNum();
    for (auto child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string kind = child->Name();
      if (kind == "collision") link.collisions.push_back(child->GetLineNum());
      if (kind == "visual") link.visuals.push_back(child->GetLineNum());
      if (kind == "collision" || kind == "visual") check_geometry(*child, name);
      if (kind == "inertial") check_mass(*child, name);
    }
    const auto [known, is_new] = result_.lines.links.emplace(name, link);
    if (!is_new) refuse_twice(element, name, known->second.line);
    links_.push_back(name);
    check_urdf_elements(element, result_.lines.file, "link '" + name + "'", result_.warnings);
  }

  void check_geometry(const XMLElement& shape, const std::string& link) const {
    const XMLElement* geometry = shape.FirstChildElement("geometry");
    if (geometry != nullptr && geometry->FirstChildElement() != nullptr) return;
    throw InputError(fmt::format(
        "{}: <{}> of link '{}' has no geometry: write <geometry> with one of box, sphere, "
        "cylinder, mesh, or remove it",
        at(shape), shape.Name(), link));
  }

  void check_mass(const XMLElement& inertial, const std::string& link) {
    const XMLElement* mass = inertial.FirstChildElement("mass");
    const double value = mass->DoubleAttribute("value", 1.0);
    if (value < 0.0) {
      throw InputError(fmt::format("{}: <mass> of link '{}' is {:g} kg, but must be >= 0",
                                   at(*mass), link, value));
    }
    if (value != 0.0) return;
    if (massless_.empty()) massless_place_ = at(*mass);
    massless_.push_back("'" + link + "'");
  }

  /// The link that `child` of `joint` ("parent" or "child") names.
  std::string link_of(const XMLElement& joint, const char* end, const std::string& name) const {
    const XMLElement* element = joint.FirstChildElement(end);
    if (element == nullptr) {
      throw InputError(fmt::format("{}: joint '{}' has no {}: write <{} link=\"...\"/>", at(joint),
                                   name, end, end));
    }
    const std::string link = element->Attribute("link");
    if (result_.lines.links.count(link) > 0) return link;
    throw InputError(fmt::format("{}: {} of joint '{}': {}", at(*element), end, name,
                                 unknown_name_message("link", link, links_)));
  }

  void add_joint(const XMLElement& element) {
    const std::string name = name_of(element);
    const auto [known, is_new] = result_.lines.joints.emplace(name, element.GetLineNum());
    if (!is_new) refuse_twice(element, name, known->second);
    check_urdf_elements(element, result_.lines.file, "joint '" + name + "'", result_.warnings);
    const std::string type = element.Attribute("type");
    const auto& types = joint_types();
    if (std::find(types.begin(), types.end(), type) == types.end()) {
      throw InputError(fmt::format("{}: joint '{}': {}", at(element), name,
                                   unknown_name_message("type", type, types)));
    }
    const std::string parent = link_of(element, "parent", name);
    const std::string child = link_of(element, "child", name);
    const bool needs_limit = type == "revolute" || type == "prismatic";
    if (needs_limit && element.FirstChildElement("limit") == nullptr) {
      throw InputError(fmt::format(
          "{}: joint '{}' is {}, but has no limit: write <limit lower=\"...\" upper=\"...\" "
          "velocity=\"...\" effort=\"...\"/>{}",
          at(element), name, type, type == "revolute" ? ", or make it continuous" : ""));
    }
    const auto [first, has_no_parent] = parent_joints_.emplace(child, ParentJoint{name, parent});
    if (!has_no_parent) {
      throw InputError(
          fmt::format("{}: link '{}' is the child of two joints, '{}' and '{}': a URDF "
                      "is a tree, so remove one",
                      at(element), child, first->second.joint, name));
    }
  }

  void check_materials() const {
    std::map<std::string, int> known;
    each("material", [&](const XMLElement& element) {
      const std::string name = name_of(element);
      const auto [first, is_new] = known.emplace(name, element.GetLineNum());
      if (!is_new) refuse_twice(element, name, first->second);
      check_urdf_elements(element, result_.lines.file, "material '" + name + "'", result_.warnings);
    });
  }

  /// Links without a parent, parents before children; each chain is followed to its end once.
  void check_tree() const {
    std::vector<std::string> roots;
    for (const std::string& link : links_) {
      if (parent_joints_.count(link) == 0) roots.push_back(link);
    }
    if (roots.size() > 1) {
      throw InputError(fmt::format(
          "{}: link '{}' is not connected to the root link '{}': no joint has it as its child. A "
          "robot is one tree: add a joint (of type fixed, if nothing moves there)",
          result_.lines.link(roots[1]), roots[1], roots[0]));
    }
    std::map<std::string, std::size_t> depths;
    if (!roots.empty()) depths[roots.front()] = 0;
    for (const std::string& link : links_) find_depth(link, depths);
  }

  void find_depth(const std::string& link, std::map<std::string, std::size_t>& depths) const {
    std::vector<std::string> chain;
    std::string at_link = link;
    while (depths.count(at_link) == 0) {
      chain.push_back(at_link);
      if (chain.size() > links_.size()) refuse_cycle(at_link);
      at_link = parent_joints_.at(at_link).parent;
    }
    std::size_t depth = depths.at(at_link);
    for (auto next = chain.rbegin(); next != chain.rend(); ++next) {
      depths[*next] = ++depth;
      if (depth > kMaxChain) {
        throw InputError(fmt::format(
            "{}: link '{}' is more than {} joints away from the root link; join links that never "
            "move against each other",
            result_.lines.link(*next), *next, kMaxChain));
      }
    }
  }

  [[noreturn]] void refuse_cycle(const std::string& link) const {
    std::vector<std::string> joints;
    std::string next = link;
    do {
      joints.push_back("'" + parent_joints_.at(next).joint + "'");
      next = parent_joints_.at(next).parent;
    } while (next != link && joints.size() < 20);
    throw InputError(fmt::format(
        "{}: link '{}' is not connected to a root link: joints form a cycle ({}): make one link "
        "the child of none",
        result_.lines.link(link), link, fmt::join(joints, ", ")));
  }

  void warn_of_masses() const {
    if (massless_.empty()) return;
    const bool is_one = massless_.size() == 1;
    result_.warnings.push_back(fmt::format(
        "{}: {} {} a mass of 0 kg: Pliant moves robots by their joints and needs no masses, but a "
        "simulator of rigid bodies would drop {}",
        massless_place_,
        fmt::format("{} {}", is_one ? "link" : "links", fmt::join(massless_, ", ")),
        is_one ? "has" : "have", is_one ? "it" : "them"));
  }

  struct ParentJoint {
    std::string joint, parent;
  };

  const XMLElement& root_;
  UrdfXml& result_;
  std::vector<std::string> links_, massless_;
  std::string massless_place_;
  std::map<std::string, ParentJoint> parent_joints_;  // by child
};

}  // namespace

UrdfXml check_urdf_xml(const std::string& text, const std::string& where) {
  tinyxml2::XMLDocument document;
  parse_xml(text, where, document);
  UrdfXml result;
  result.lines.file = where;
  const XMLElement* root = document.RootElement();
  if (root == nullptr) throw InputError(where + ": the URDF is empty: it holds no element");
  const std::string place = result.lines.at(root->GetLineNum());
  if (std::string(root->Name()) != "robot") {
    const bool is_sdf = std::string(root->Name()) == "sdf";
    throw InputError(fmt::format("{}: the root element is <{}>, but that of a URDF is <robot>{}",
                                 place, root->Name(),
                                 is_sdf ? "; this is SDF, which is another format" : ""));
  }
  refuse_xacro(*root, where);
  result.text = text;
  if (mend_urdf(document, where, result.warnings)) {
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    result.text = printer.CStr();
  }
  UrdfIndex(*root, result).check();
  return result;
}

}  // namespace pliant
