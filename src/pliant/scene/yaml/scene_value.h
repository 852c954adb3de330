#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "pliant/scene/yaml/yaml_tree.h"

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

/// A table of values: a column a path, a row a scene. Rows are read one after the other, so that
/// there may be any number of them.
class SceneTable {
 public:
  /// Of so many scenes that do not differ.
  explicit SceneTable(std::size_t copies) : size_(copies) {}
  /// Of a CSV file (RFC 4180 without line breaks in cells: those with commas stand in quotes) whose
  /// first line holds the paths. Throws InputError "FILE:LINE: ...": no rows, a row of another
  /// length, a path given twice.
  explicit SceneTable(const std::string& path);

  const std::string& path() const { return path_; }  ///< "": of no file
  std::size_t size() const { return size_; }         ///< rows
  const std::vector<std::string>& paths() const { return paths_; }
  /// The next row; the first one at first. Throws InputError where the file is another by now.
  std::vector<SceneValue> next();
  /// Back to the first row.
  void rewind();

 private:
  bool next_line(std::string& line);
  void take_paths(const std::vector<std::string>& cells);
  void check_cells(const std::vector<std::string>& cells) const;

  std::string path_;  // empty: of no file
  std::vector<std::string> paths_;
  std::size_t size_ = 0;
  std::ifstream file_;
  int line_ = 0;  // that was read last
};

}  // namespace pliant
