#pragma once

#include <string>
#include <vector>

namespace tinyxml2 {
class XMLDocument;
}

namespace pliant {

/// Takes out of a URDF what Pliant can do without and the library that makes the model would refuse
/// it for, and reads what is meant: a robot without a name, masses that are incomplete, materials
/// that are defined nowhere, collision shapes of no size, what stands beside a shape, commas
/// between numbers, numbers too many, package:/// for package://. Each is told in a warning
/// "FILE:LINE: ...". Returns whether anything was changed. `document` has a root element; `file` is
/// named in the warnings.
bool mend_urdf(tinyxml2::XMLDocument& document, const std::string& file,
               std::vector<std::string>& warnings);

}  // namespace pliant
