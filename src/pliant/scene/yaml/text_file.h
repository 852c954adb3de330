#pragma once

#include <fstream>
#include <string>

namespace pliant {

/// Throws InputError beginning with the path when it is missing, no regular file or unreadable.
std::ifstream open_text_file(const std::string& path);

/// The bytes of a file. Throws InputError as open_text_file() does, and when it is longer than
/// `max_bytes`.
std::string read_text_file(const std::string& path, std::size_t max_bytes);

/// Throws InputError "FILE:LINE: ..." when `text`, which begins in line `line`, has a null
/// character or is not UTF-8.
void check_text(const std::string& text, const std::string& file, int line = 1);

}  // namespace pliant
