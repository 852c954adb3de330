#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/effects/registry.h"
#include "pliant/elements/registry.h"
#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/reading/attachment_parameters.h"
#include "pliant/scene/reading/fabrics.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/scene/reading/obstacle_parameters.h"
#include "pliant/scene/robot/robot_parameters.h"
#include "pliant/scene/yaml/scene_formats.h"
#include "pliant/solvers/registry.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

std::string default_text(const ParameterSpec& spec) {
  return spec.default_value.empty() ? "required" : spec.default_value;
}

/// A '|' would end the cell.
std::string cell(const std::string& text) {
  std::string escaped;
  for (char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

/// Lines of at most 110 characters, as everywhere in the docs.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kColumns = 110;
  std::istringstream words(text);
  std::string word, line, lines;
  while (words >> word) {
    if (!line.empty() && line.size() + 1 + word.size() > kColumns) {
      lines += line + '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

void print_parameter_table(const std::vector<ParameterSpec>& specs) {
  if (specs.empty()) return;
  fmt::print("\n| parameter | default | allowed | meaning |\n|---|---|---|---|\n");
  for (const ParameterSpec& spec : specs) {
    fmt::print("| `{}` | {} | {} | {} |\n", spec.name, cell(default_text(spec)),
               cell(spec.range_text()), cell(spec.meaning));
  }
}

template <class Entry>
std::string note(const Entry&) {
  return "";
}

template <>
std::string note(const ModelRegistry::Entry& model) {
  const DefaultSolver alone = default_solver_among(model.name, {model.name}, true);
  return fmt::format(" Default solver: `{}`.", alone.text());
}

/// What a scene may say of two bodies alone; these parameters stand in for the effect's.
template <class Entry>
void print_pair_keys(const Entry& entry, bool markdown) {
  if (entry.pair_parameters.empty()) return;
  const char* const text =
      "Every two bodies touch, but those under `except:`, a list of [BODY, BODY], which pass "
      "without a warning; with `only_pairs: true` none touch but those under `pairs:`, and others "
      "that come near each other are warned of. `pairs:` is a list of maps with `bodies: [BODY, "
      "BODY]`, and with any of these in place of the effect's own:";
  if (!markdown) {
    fmt::print("    {}\n", text);
    for (const ParameterSpec& spec : entry.pair_parameters) {
      fmt::print("      {}   {}\n", spec.name, spec.range_text());
    }
    return;
  }
  fmt::print("\n{}\n\n| parameter | allowed |\n|---|---|\n", wrapped(text));
  for (const ParameterSpec& spec : entry.pair_parameters) {
    fmt::print("| `{}` | {} |\n", spec.name, cell(spec.range_text()));
  }
}

template <class Registry>
void print_registry(const std::string& title, const Registry& registry, bool markdown) {
  fmt::print(markdown ? "## {}\n" : "{}:\n", title);
  for (const auto& entry : registry.entries()) {
    const std::string models = fmt::format("{}", fmt::join(entry.models, ", "));
    if (markdown) {
      fmt::print("\n### `{}`\n\n{}\n", entry.name,
                 wrapped(fmt::format("{}. Models: {}.{}", entry.description, models, note(entry))));
      print_parameter_table(entry.parameters);
    } else {
      fmt::print("  {}: {} (models: {}){}\n", entry.name, entry.description, models, note(entry));
      fmt::print("{}", describe_parameters(entry.parameters));
    }
    print_pair_keys(entry, markdown);
  }
  fmt::print("\n");
}

void print_geometries(bool markdown) {
  fmt::print(markdown ? "## Geometries\n" : "Geometries:\n");
  for (const GeometryKind& kind : geometry_kinds()) {
    const std::string models = fmt::format("{}", fmt::join(kind.models, ", "));
    if (markdown) {
      fmt::print("\n### `{}`\n\n{}\n", kind.name,
                 wrapped(fmt::format("{}. Models: {}.", kind.description, models)));
      if (!kind.size.empty()) fmt::print("\nIn a map under its name:\n");
      print_parameter_table(kind.size);
      if (!kind.options.empty()) fmt::print("\nBeside its name:\n");
      print_parameter_table(kind.options);
    } else {
      fmt::print("  {}: {} (models: {})\n", kind.name, kind.description, models);
      fmt::print("{}{}", describe_parameters(kind.size), describe_parameters(kind.options));
    }
  }
  fmt::print("\n");
}

/// Parameters of a scene's own items, which no registry holds.
void print_scene_items(const char* title, const char* description,
                       const std::vector<ParameterSpec>& specs, bool markdown) {
  if (markdown) {
    fmt::print("## {}\n\n{}\n", title, wrapped(fmt::format("{}. Models: all.", description)));
    print_parameter_table(specs);
  } else {
    fmt::print("{}:\n  {}.\n{}", title, description, describe_parameters(specs));
  }
  fmt::print("\n");
}

void print_attachments(bool markdown) {
  print_scene_items(
      "Attachments",
      "Vertices of a body that springs hold to the world, an obstacle or a robot link. A list "
      "under a body's `attachments:`; each item has a `name`, one of `corner`, `vertices`, `box` "
      "and `sphere`, as under `fixed:`, and `to`: the name of an obstacle or of a robot link with "
      "a collision shape (default: world)",
      attachment_parameters(), markdown);
}

void print_obstacles(bool markdown) {
  print_scene_items("Obstacles",
                    "What bodies touch. A list under `obstacles:`; each item has a `name`, a "
                    "`shape` with its sizes, `position`, `rotation_rpy`, `color`",
                    obstacle_parameters(), markdown);
}

/// Keys whose values are no parameters.
void print_keys(const std::vector<KeyText>& keys, bool markdown) {
  if (markdown) fmt::print("\n| key | value | meaning |\n|---|---|---|\n");
  for (const KeyText& key : keys) {
    if (markdown) {
      fmt::print("| `{}` | {} | {} |\n", key.name, cell(key.format), cell(key.meaning));
    } else {
      fmt::print("      {}   {}\n        {}\n", key.name, key.format, key.meaning);
    }
  }
}

void print_format(const SceneFormat& format, bool markdown) {
  if (markdown) {
    fmt::print("## {}\n\n{}\n", format.title, wrapped(format.description + "."));
    if (!format.keys.empty()) print_keys(format.keys, true);
    print_parameter_table(format.parameters);
    if (!format.example.empty()) fmt::print("\n```yaml\n{}```\n", format.example);
  } else {
    fmt::print("{}:\n  {}.\n", format.title, format.description);
    print_keys(format.keys, false);
    fmt::print("{}", describe_parameters(format.parameters));
    if (!format.example.empty()) fmt::print("\n{}", format.example);
  }
  fmt::print("\n");
}

void print_robots(bool markdown) {
  print_format({"Robot",
                "Its links are obstacles. A map under `robot:`, or a list of maps, one a robot; "
                "besides these keys `position` and `rotation_rpy` of its base",
                robot_keys(), robot_parameters()},
               markdown);
}

void print_formats(const std::vector<SceneFormat>& formats, bool markdown) {
  for (const SceneFormat& format : formats) print_format(format, markdown);
}

void print_fabrics(bool markdown) {
  if (markdown) {
    fmt::print(
        "## Fabrics\n\nOf the model `cloth`, as `fabric:` under a body's `material:`; what else "
        "the material says takes the\nplace of the fabric's figures. More in "
        "`config/fabrics.yaml`.\n\n| fabric | what | figures | source |\n|---|---|---|---|\n");
  } else {
    fmt::print("Fabrics:\n");
  }
  for (const Fabric& fabric : fabrics()) {
    std::string figures;
    for (const auto& [name, value] : fabric.parameters) {
      figures += fmt::format("{}{} {}", figures.empty() ? "" : ", ", name, value);
    }
    fmt::print(markdown ? "| `{}` | {} | {} | {} |\n" : "  {}: {} ({}; {})\n", fabric.name,
               cell(fabric.description), cell(figures), cell(fabric.source));
  }
  fmt::print("\n");
}

void print_elements(bool markdown) {
  fmt::print(markdown ? "## Elements\n\n| element | what |\n|---|---|\n" : "Elements:\n");
  for (const ElementKind& kind : element_kinds()) {
    fmt::print(markdown ? "| `{}` | {} |\n" : "  {}: {}\n", kind.name, cell(kind.description));
  }
  fmt::print("\n");
}

struct ListOptions {
  std::string kind;
  bool markdown = false;
};

struct ListKind {
  const char* name;
  void (*print)(bool markdown);
};

/// What there is to list, in the order in which everything is.
const std::vector<ListKind>& list_kinds() {
  static const std::vector<ListKind> all = {
      {"solvers", [](bool markdown) { print_registry("Solvers", solver_registry(), markdown); }},
      {"time_integrations",
       [](bool markdown) { print_registry("Time integrations", time_integrations(), markdown); }},
      {"integrators",
       [](bool markdown) { print_registry("Integrators", integrator_registry(), markdown); }},
      {"effects", [](bool markdown) { print_registry("Effects", effect_registry(), markdown); }},
      {"models", [](bool markdown) { print_registry("Models", model_registry(), markdown); }},
      {"geometries", print_geometries},
      {"fabrics", print_fabrics},
      {"attachments", print_attachments},
      {"obstacles", print_obstacles},
      {"robot", print_robots},
      {"regions", [](bool markdown) { print_formats(region_formats(), markdown); }},
      {"keyframes", [](bool markdown) { print_formats(keyframe_formats(), markdown); }},
      {"elements", print_elements}};
  return all;
}

void print_list(const ListOptions& options) {
  for (const ListKind& kind : list_kinds()) {
    if (options.kind.empty() || options.kind == kind.name) kind.print(options.markdown);
  }
  std::fflush(stdout);
}

}  // namespace

void add_list_command(CLI::App& app, int& exit_code) {
  std::vector<std::string> names;
  for (const ListKind& kind : list_kinds()) names.emplace_back(kind.name);
  CLI::App* command = add_command(
      app, "list", fmt::format("List {} with their parameters", fmt::join(names, ", ")));
  auto options = std::make_shared<ListOptions>();
  command->add_option("kind", options->kind, "What to list; everything without it")
      ->check(CLI::IsMember(names));
  command->add_flag("--markdown", options->markdown, "As tables for the documentation");
  command->callback([options, &exit_code] {
    print_list(*options);
    exit_code = kOk;
  });
}

}  // namespace pliant
