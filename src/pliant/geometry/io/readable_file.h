#pragma once

#include <string>
#include <vector>

namespace pliant {

/// The file's extension in lower case, without its dot. Throws InputError "mesh '<path>': ..." when
/// there is no such file, it is none or cannot be read, or its extension is not in `allowed`.
std::string checked_extension(const std::string& path, const std::vector<std::string>& allowed);

/// Why `part`, which the mesh file `path` names, is not read with it: it is outside of the mesh's
/// folder, or no regular file; empty where it is.
std::string why_no_part(const std::string& path, const std::string& part);

/// All bytes of a file. Throws InputError when it cannot be read.
std::string read_bytes(const std::string& path);

}  // namespace pliant
