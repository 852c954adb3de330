#pragma once

#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

/// That one shape may have.
constexpr int kMaxShapePatches = 100'000;

/// Patches of simple shapes, centred at the origin; base vertices lie on the shape, quadrics are
/// fitted to it. All throw InputError, naming the parameter and its range, for a length that is not
/// positive and finite or a count outside its range, and, before they make anything, for counts
/// that together make more than kMaxShapePatches.

/// 20 * 4^level triangles, level 0 to 4. One quadric is the whole shape, at any level.
PatchBody make_sphere_patches(double radius, int level = 0);

/// About z, `tube` < `ring` [m]; 2 * around * across triangles, 3 to 1000 each.
PatchBody make_torus_patches(double ring, double tube, int around = 16, int across = 8);

/// Along z: a cylinder of that length between two half balls; 4 * around * rings triangles, around
/// 3 to 1000, rings of each half ball 1 to 1000.
PatchBody make_capsule_patches(double radius, double length, int around = 8, int rings = 2);

/// Edge lengths `size` [m], edges and corners rounded by `radius` [m], at most half the least size
/// less 1e-3 of it; `segments` 1 to 100 on each quarter turn.
PatchBody make_rounded_box_patches(const Eigen::Vector3d& size, double radius, int segments = 2);

}  // namespace pliant
