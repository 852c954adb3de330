#pragma once

#include <urdf_model/model.h>

#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/robot/urdf_lines.h"

namespace pliant {

constexpr std::size_t kMaxUrdfBytes = 16'000'000;

struct ParsedUrdf {
  std::shared_ptr<urdf::ModelInterface> model;
  UrdfXml xml;
};

/// Parses URDF. Throws InputError beginning with `where` for text that is too long or no text, for
/// what check_urdf_xml() refuses, and with what the parser said.
ParsedUrdf parse_urdf(const std::string& urdf, const std::string& where);

/// The links, parents first, children in the order of their joints' names. Throws InputError for
/// joints without axis, with limits the wrong way round, and a mimic of a joint that is missing,
/// fixed or mimics it back.
std::vector<urdf::LinkConstSharedPtr> check_urdf(const urdf::ModelInterface& model,
                                                 const UrdfLines& lines);

/// Whether the joint moves by a position of its own.
bool is_active(const urdf::Joint& joint);
/// Whether it is floating or planar: what lies behind it moves by a pose.
bool is_free(const urdf::Joint& joint);

}  // namespace pliant
