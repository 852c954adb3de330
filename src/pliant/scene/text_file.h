#pragma once

#include <string>

namespace pliant {

/// The bytes of a file. Throws InputError beginning with the path when it is missing, no regular
/// file, unreadable or longer than `max_bytes`.
std::string read_text_file(const std::string& path, std::size_t max_bytes);

/// Throws InputError "FILE:LINE: ..." when `text` has a null character or is not UTF-8.
void check_text(const std::string& text, const std::string& file);

}  // namespace pliant
