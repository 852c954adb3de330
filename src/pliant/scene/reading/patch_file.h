#pragma once

#include <string>

#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

/// Reads a body of free-form patches, a YAML file:
///   dents: true                       # whether Q < 0 perturbs inward; optional
///   vertices: [[x, y, z], ...]        # [m], of the base
///   triangles: [[a, b, c], ...]       # vertex indices, counter-clockwise seen from outside
///   edges: [{vertices: [a, b], quadric: [xx, yy, zz, xy, yz, zx, x, y, z, 1]}, ...]
/// with the coefficients of Q, whose cube is a height [m], on every edge of the base, in any order.
/// Throws InputError "FILE:LINE: ..." for what such a file must not be, and as validate() does.
PatchBody read_patch_body(const std::string& path);

/// The same of a text that is known as `file` in messages.
PatchBody parse_patch_body(const std::string& text, const std::string& file);

/// The text of a file that gives back the same doubles.
std::string patch_body_text(const PatchBody& body);

/// Writes it; the file appears complete or not at all. Throws InputError when it cannot be written.
void write_patch_body(const std::string& path, const PatchBody& body);

}  // namespace pliant
