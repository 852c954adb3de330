#pragma once

#include <string>
#include <vector>

#include "pliant/scene/yaml_tree.h"

namespace pliant {

/// A value to put into a scene file's tree in place of what is there.
struct SceneValue {
  std::string path;  ///< as in error messages: "bodies[0].material.density"; a list's item also by
                     ///< its name: "obstacles[ball].radius"
  std::string text;  ///< as YAML in one line: "0.5", "[0, 0, 1]"
  SourcePlace place;
};

/// Puts the value where its path says; keys that are not there yet are added, so that what the
/// scene does not know is refused where it is read. Throws InputError "FILE:LINE: ..." for a path
/// that leads nowhere and a text that is no YAML.
void set_value(const SceneValue& value, YamlNode& root);

/// A table of values: a column a path, a row a scene.
struct SceneValueTable {
  std::vector<std::string> paths;
  std::vector<std::vector<SceneValue>> rows;
};

/// Reads a CSV file (RFC 4180: cells with commas stand in quotes) whose first line holds the paths.
/// Throws InputError "FILE:LINE: ...": no rows, a row of another length, a path given twice.
SceneValueTable read_scene_values(const std::string& path);

}  // namespace pliant
