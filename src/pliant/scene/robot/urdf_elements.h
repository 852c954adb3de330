#pragma once

#include <string>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace pliant {

/// Checks the elements of a link or a joint of URDF, of every depth: attributes that are missing or
/// no numbers. Throws InputError "FILE:LINE: ..."; `owner` is "link 'hand'". What looks misspelt is
/// appended to `warnings`.
void check_urdf_elements(const tinyxml2::XMLElement& element, const std::string& file,
                         const std::string& owner, std::vector<std::string>& warnings);

}  // namespace pliant
