#include <fmt/format.h>

#include "pliant/math/error.h"
#include "pliant/scene/reading/attachment_parameters.h"
#include "pliant/scene/reading/scene_readers.h"

namespace pliant {
namespace {

AttachmentSpec read_attachment(const YamlNode& node, const std::string& field, bool is_grid,
                               std::vector<std::string>& names) {
  std::vector<std::string> others = region_keys();
  others.insert(others.end(), {"name", "to"});
  const YamlMap map(node, field, attachment_parameters(), others);
  AttachmentSpec attachment;
  attachment.place = map.place();
  attachment.name = read_unique_name(map, names);
  attachment.region = read_region(map, is_grid);
  if (const YamlNode* to = map.find("to")) {
    attachment.to = read_text(*to, map.field("to"));
  } else {
    attachment.to = "world";
  }
  attachment.stiffness = map.number("stiffness");
  attachment.from = map.number("from");
  if (map.has("until")) {
    attachment.until = map.number("until");
    if (!(*attachment.until > attachment.from)) {
      throw InputError(fmt::format("{}: {} is {:g} s, but must be after 'from', {:g} s",
                                   map.find("until")->place().text(), map.field("until"),
                                   *attachment.until, attachment.from));
    }
  }
  return attachment;
}

}  // namespace

std::vector<ParameterSpec> attachment_parameters() {
  constexpr double kLongest = 1e9;  // [s]
  return {positive_parameter("stiffness", "N/m", "", 1e12,
                             "of all its vertices together, shared in proportion to mass"),
          number_parameter("from", "s", "0", 0.0, kLongest,
                           "simulated time at which vertices are looked for and held where they "
                           "are then"),
          number_parameter("until", "s", "1e9", 0.0, kLongest, "when it lets go")};
}

std::vector<AttachmentSpec> read_attachments(const YamlNode& list, const std::string& field,
                                             bool is_grid) {
  std::vector<AttachmentSpec> attachments;
  std::vector<std::string> names;
  const auto& items = read_list(list, field, "a list of {name, box, stiffness, to, ...}");
  for (std::size_t i = 0; i < items.size(); ++i) {
    attachments.push_back(
        read_attachment(items[i], fmt::format("{}[{}]", field, i), is_grid, names));
  }
  return attachments;
}

}  // namespace pliant
