#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/patch/patch_shapes.h"
#include "pliant/scene/reading/geometry_kinds.h"

namespace pliant {
namespace {

ParameterSpec length(const char* name, const char* default_value, const char* meaning) {
  return positive_parameter(name, "m", default_value, kMaxShapeSize, meaning);
}

}  // namespace

const Registry<PatchBody>& patch_shape_registry() {
  static const Registry<PatchBody> registry = [] {
    Registry<PatchBody> built("shape");
    built.add({"sphere",
               "a ball: 20 * 4^level patches",
               {length("radius", "", "of the sphere"),
                integer_parameter("level", "0", 0, 4, "of detail; 0 is exact to 6e-5")},
               {"patch"},
               [](const Parameters& p) {
                 return std::make_unique<PatchBody>(
                     make_sphere_patches(p.number("radius"), p.integer("level")));
               }});
    built.add({"torus",
               "a ring about z: 2 * around * across patches",
               {length("ring", "", "radius of the ring's centre line"),
                length("tube", "", "radius of its cross section, below `ring`"),
                integer_parameter("around", "16", 3, 1000, "cuts along the ring"),
                integer_parameter("across", "8", 3, 1000, "cuts about the tube")},
               {"patch"},
               [](const Parameters& p) {
                 return std::make_unique<PatchBody>(make_torus_patches(
                     p.number("ring"), p.number("tube"), p.integer("around"), p.integer("across")));
               }});
    built.add({"capsule",
               "a cylinder along z with round ends: 4 * around * rings patches",
               {length("radius", "", "of cylinder and ends"),
                length("length", "", "of the cylinder part"),
                integer_parameter("around", "8", 3, 1000, "cuts about the axis"),
                integer_parameter("rings", "2", 1, 1000, "cuts of each round end")},
               {"patch"},
               [](const Parameters& p) {
                 return std::make_unique<PatchBody>(
                     make_capsule_patches(p.number("radius"), p.number("length"),
                                          p.integer("around"), p.integer("rings")));
               }});
    built.add({"rounded_box",
               "a box with round edges and corners",
               {vector_parameter("size", "m", "", kMaxShapeSize, "full extents"),
                length("radius", "", "of edges and corners, below half the least size"),
                integer_parameter("segments", "2", 1, 100, "on each quarter turn")},
               {"patch"},
               [](const Parameters& p) {
                 return std::make_unique<PatchBody>(make_rounded_box_patches(
                     p.vector("size"), p.number("radius"), p.integer("segments")));
               }});
    return built;
  }();
  return registry;
}

}  // namespace pliant
