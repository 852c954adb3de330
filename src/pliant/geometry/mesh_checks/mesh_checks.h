#pragma once

#include <string>
#include <string_view>

namespace pliant {

// What assimp does not check of a file before it trusts it. Each throws InputError
// "mesh '<path>': ..." for a file that announces more than it holds, or that assimp would follow
// without end; what is not valid otherwise is left to assimp.

/// Elements and lists of a PLY file.
void check_ply(const std::string& path, std::string_view bytes);

/// A glTF file, text or binary (`is_binary`, .glb): lengths of its chunks, buffers and accessors
/// against the sizes of the files that hold them, which have to be regular ones in the folder of
/// `path` or below it, and its nodes.
void check_gltf(const std::string& path, std::string_view bytes, bool is_binary);

/// A COLLADA file: counts, nesting and nodes, with their instances.
void check_collada(const std::string& path, std::string_view bytes);

}  // namespace pliant
