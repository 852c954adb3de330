#include "pliant/scene/robot/urdf_mend.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/source_place.h"

namespace pliant {
namespace {

using tinyxml2::XMLElement;

const char* text_or_none(const char* text) { return text == nullptr ? "" : text; }

class UrdfMender {
 public:
  UrdfMender(XMLElement& root, const std::string& file, std::vector<std::string>& warnings)
      : root_(root), file_(file), warnings_(warnings) {}

  bool mend() {
    const std::size_t before = warnings_.size();
    if (*text_or_none(root_.Attribute("name")) == '\0') {
      warn(root_, "<robot> has no name and is called 'robot'");
      root_.SetAttribute("name", "robot");
    }
    mend_attributes(root_);
    take_materials(root_);
    for (XMLElement* link = root_.FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
      mend_link(*link);
    }
    return warnings_.size() > before;
  }

 private:
  void warn(const XMLElement& element, const std::string& text) {
    warnings_.push_back(SourcePlace{file_, element.GetLineNum()}.text() + ": " + text);
  }

  /// Of all depths, which reading the file has bounded.
  void mend_attributes(XMLElement& element) {
    for (const char* name : {"xyz", "rpy", "size", "scale", "rgba"}) mend_numbers(element, name);
    const std::string file = text_or_none(element.Attribute("filename"));
    if (file.rfind("package:///", 0) == 0) {
      warn(element, fmt::format("'{}' is taken for 'package://{}'", file, file.substr(11)));
      element.SetAttribute("filename", ("package://" + file.substr(11)).c_str());
    }
    for (XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      mend_attributes(*child);
    }
  }

  void mend_numbers(XMLElement& element, const std::string& name) {
    const std::string given = text_or_none(element.Attribute(name.c_str()));
    std::string numbers = given;
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    if (numbers != given) {
      warn(element, fmt::format("<{}> has {}=\"{}\": commas are taken for blanks, which separate "
                                "numbers in URDF",
                                element.Name(), name, given));
    }
    const std::size_t count = name == "rgba" ? 4 : 3;
    std::istringstream stream(numbers);
    const std::vector<std::string> all{std::istream_iterator<std::string>(stream), {}};
    if (all.size() > count) {
      warn(element, fmt::format("<{}> has {}=\"{}\": of its {} numbers the first {} are taken",
                                element.Name(), name, given, all.size(), count));
      numbers = fmt::format(
          "{}", fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), " "));
    }
    if (numbers != given) element.SetAttribute(name.c_str(), numbers.c_str());
  }

  /// Those that `parent` defines; of links in their order, since others may use them after that.
  void take_materials(const XMLElement& parent) {
    for (auto material = parent.FirstChildElement("material"); material != nullptr;
         material = material->NextSiblingElement("material")) {
      if (material->FirstChildElement() == nullptr) continue;
      materials_.insert(text_or_none(material->Attribute("name")));
    }
  }

  void mend_link(XMLElement& link) {
    const std::string name = text_or_none(link.Attribute("name"));
    for (XMLElement *child = link.FirstChildElement(), *next = nullptr; child != nullptr;
         child = next) {
      next = child->NextSiblingElement();
      const std::string kind = child->Name();
      const bool is_of_no_use = (kind == "inertial" && lacks_a_part(*child, name)) ||
                                (kind == "collision" && has_no_size(*child, name));
      if (kind == "visual") drop_unknown_material(*child, name);
      if (kind == "visual" || kind == "collision") drop_what_is_no_shape(*child, name);
      if (is_of_no_use) link.DeleteChild(child);
    }
  }

  bool lacks_a_part(const XMLElement& inertial, const std::string& link) {
    for (const char* part : {"mass", "inertia"}) {
      if (inertial.FirstChildElement(part) != nullptr) continue;
      warn(inertial,
           fmt::format("<inertial> of link '{}' has no <{}> and is left out: Pliant needs "
                       "no masses, other programs will",
                       link, part));
      return true;
    }
    return false;
  }

  bool has_no_size(const XMLElement& collision, const std::string& link) {
    const XMLElement* geometry = collision.FirstChildElement("geometry");
    const XMLElement* sphere =
        geometry == nullptr ? nullptr : geometry->FirstChildElement("sphere");
    if (sphere == nullptr || sphere->DoubleAttribute("radius", 1.0) != 0.0) return false;
    warn(collision,
         fmt::format("<collision> of link '{}' is a sphere of no size and is left out: it "
                     "touches nothing",
                     link));
    return true;
  }

  /// Beside a shape.
  void drop_what_is_no_shape(XMLElement& owner, const std::string& link) {
    XMLElement* geometry = owner.FirstChildElement("geometry");
    if (geometry == nullptr) return;
    const auto is_shape = [](const XMLElement& element) {
      const std::string name = element.Name();
      return name == "box" || name == "sphere" || name == "cylinder" || name == "mesh";
    };
    const XMLElement* first = geometry->FirstChildElement();
    if (first == nullptr || !is_shape(*first)) return;
    for (XMLElement *child = geometry->FirstChildElement(), *next = nullptr; child != nullptr;
         child = next) {
      next = child->NextSiblingElement();
      if (is_shape(*child)) continue;
      warn(*child, fmt::format("<geometry> of link '{}' holds <{}> beside its shape, which is left "
                               "out",
                               link, child->Name()));
      geometry->DeleteChild(child);
    }
  }

  void drop_unknown_material(XMLElement& visual, const std::string& link) {
    take_materials(visual);
    XMLElement* material = visual.FirstChildElement("material");
    if (material == nullptr || material->FirstChildElement() != nullptr) return;
    const std::string name = text_or_none(material->Attribute("name"));
    if (name.empty() || materials_.count(name) > 0) return;
    const std::vector<std::string> names(materials_.begin(), materials_.end());
    warn(*material, fmt::format("link '{}': {}; its colour is left out. Give it a <color "
                                "rgba=\"...\"/>, or define it beside the links",
                                link, unknown_name_message("material", name, names)));
    visual.DeleteChild(material);
  }

  XMLElement& root_;
  const std::string& file_;
  std::vector<std::string>& warnings_;
  std::set<std::string> materials_;
};

}  // namespace

bool mend_urdf(tinyxml2::XMLDocument& document, const std::string& file,
               std::vector<std::string>& warnings) {
  return UrdfMender(*document.RootElement(), file, warnings).mend();
}

}  // namespace pliant
