#pragma once

#include <urdf_model/model.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pliant {

constexpr std::size_t kMaxUrdfBytes = 16'000'000;
constexpr std::size_t kMaxLinks = 10'000;

/// Gives "FILE:LINE" of the element `tag` ("link", "joint") with that name, or just the file.
using UrdfPlace = std::function<std::string(const std::string& tag, const std::string& name)>;
UrdfPlace urdf_place(const std::string& urdf, const std::string& where);

/// Parses URDF. Throws InputError beginning with `where` with what the parser said; for text that
/// is too long or nested too deep; and for what check_urdf() refuses.
std::shared_ptr<const urdf::ModelInterface> parse_urdf(const std::string& urdf,
                                                       const std::string& where);

/// The links, parents first, children in the order of their joints' names. Throws InputError for
/// more than kMaxLinks links, links that are not one tree, joints of unsupported type, without
/// axis, with limits the wrong way round, numbers that are not finite, and a mimic of a joint that
/// is missing, fixed or mimics it back.
std::vector<urdf::LinkConstSharedPtr> check_urdf(const urdf::ModelInterface& model,
                                                 const UrdfPlace& place);

/// Whether the joint moves by a position of its own.
bool is_active(const urdf::Joint& joint);

}  // namespace pliant
