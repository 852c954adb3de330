#include "pliant/scene/reading/fabrics.h"

#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "pliant/scene/yaml/yaml_map.h"

namespace pliant {
namespace {

std::vector<Fabric> read_fabrics() {
  const YamlNode root = parse_yaml(kFabricsText, "config/fabrics.yaml");
  const YamlMap file(root, "", {}, {"fabrics"});
  std::vector<Fabric> read;
  for (const YamlNode& item : read_list(file.require("fabrics", "a list"), "fabrics", "a list")) {
    const YamlMap map(item, "fabrics", {}, {"name", "description", "source", "material"});
    Fabric fabric;
    fabric.name = read_name(map.require("name", "a name"), "name");
    fabric.description = read_text(map.require("description", "one line"), "description");
    fabric.source = read_text(map.require("source", "where its figures are from"), "source");
    fabric.parameters = read_parameters(map.require("material", "parameters of cloth"), "material",
                                        model_registry().find("cloth").parameters);
    read.push_back(std::move(fabric));
  }
  return read;
}

}  // namespace

const std::vector<Fabric>& fabrics() {
  static const std::vector<Fabric> all = read_fabrics();
  return all;
}

const Fabric& find_fabric(const std::string& name) {
  std::vector<std::string> names;
  for (const Fabric& fabric : fabrics()) {
    if (fabric.name == name) return fabric;
    names.push_back(fabric.name);
  }
  throw InputError(unknown_name_message("fabric", name, names));
}

}  // namespace pliant
