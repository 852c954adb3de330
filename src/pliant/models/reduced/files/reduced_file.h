#pragma once

#include <cstdint>
#include <string>

#include "pliant/models/reduced/reduced_model.h"

namespace pliant {

/// Version of the file format that is written. Version 1, without a surface, is read too; others
/// are refused.
constexpr std::uint32_t kReducedFileVersion = 2;

/// Writes a reduced model; the file appears complete or not at all. Throws InputError when it
/// cannot be written. Everything is little-endian, and docs/reduced.md has the layout:
///   "PLIANTRM", u32 version, u32 0x01020304, u64 bytes of the body, u64 their FNV-1a checksum;
///   body: u32 + characters of the name; f64 young, poisson, density; u32 modes, n, m, r;
///   f64 vertices (3n), i32 tetrahedra (4m), u8 fixed (n), f64 U (3n r, column by column), f64 λ
///   (r), f64 coefficients in the order of QuarticPotential::index(); u32 s, t, f64 vertices (3s)
///   and i32 triangles (3t) of the surface, 0 of both where it is the tetrahedra's boundary.
void write_reduced_model(const std::string& path, const ReducedModel& model);

/// Throws InputError, naming the file and what is wrong, when it is missing, no such file, of
/// another version or byte order, truncated, longer than it says, altered (checksum), or holds what
/// makes no model: sizes out of range, a mesh or a surface that validate() refuses, numbers that
/// are not finite, a basis that moves fixed vertices.
ReducedModel read_reduced_model(const std::string& path);

}  // namespace pliant
