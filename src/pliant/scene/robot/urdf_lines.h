#pragma once

#include <map>
#include <string>
#include <vector>

#include "pliant/scene/yaml/source_place.h"

namespace pliant {

/// Where the elements of a URDF were written, for messages; each "FILE:LINE".
struct UrdfLines {
  struct Link {
    int line = 1;
    std::vector<int> collisions, visuals;  ///< lines of its elements of that name
  };

  std::string file;
  std::map<std::string, Link> links;
  std::map<std::string, int> joints;

  std::string at(int line) const { return SourcePlace{file, line}.text(); }
  std::string link(const std::string& name) const { return at(links.at(name).line); }
  std::string joint(const std::string& name) const { return at(joints.at(name)); }
};

/// A URDF's elements as far as its XML tells.
struct UrdfXml {
  UrdfLines lines;
  std::vector<std::string> warnings;  ///< what is legal but surely not meant
  std::string text;                   ///< for the library that makes the model: mend_urdf()
};

constexpr std::size_t kMaxLinks = 10'000;
/// Joints from the root to any link; urdfdom and KDL recurse along them.
constexpr std::size_t kMaxChain = 1'000;

/// Reads URDF as XML and checks what the library that makes the model of it would refuse without a
/// line, or pass over in silence: elements and attributes that are missing, misspelt, given twice
/// or of the wrong form, and links that are not one tree. Throws InputError "FILE:LINE: ..." that
/// names the element and what to write; for xacro text it names the command that expands it.
/// `where` is the file.
UrdfXml check_urdf_xml(const std::string& text, const std::string& where);

}  // namespace pliant
