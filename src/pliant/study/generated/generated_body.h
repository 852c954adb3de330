#pragma once

#include <string>

#include "pliant/study/generated/generated_factors.h"

namespace pliant {

/// Writes quantities of a scene whose lengths are `length` times what they are given as, and whose
/// masses its cube times: kilograms to the power of `mass` and metres to that of `meters`.
class SceneUnits {
 public:
  explicit SceneUnits(double length) : length_(length) {}
  double scaled(double value, int mass, int meters) const;
  std::string operator()(double value, int mass, int meters) const;
  double length() const { return length_; }

 private:
  double length_;
};

/// Of liquids, told with length 1 [m/s].
inline constexpr double kGeneratedSound = 5.0;

/// How far a body reaches, told with length 1.
struct BodyExtent {
  double half_height;  ///< along its z [m]
  double radius;       ///< of a ball about its origin that holds it [m]
};

BodyExtent extent_of(const SceneChoice& choice);
/// Where the shape of a body comes from.
struct BodyMesh {
  std::string path;          ///< of a file; "": from the geometry's own kind
  bool is_mirrored = false;  ///< y is turned round, and so are directions of the material
};

/// "geometry: {...}, material: {...}" of the scene's first body.
std::string body_text(const SceneChoice& choice, const SceneUnits& units,
                      const BodyMesh& mesh = {});
/// Whether all that the body is made of is in a file of its mesh.
bool may_be_read(const SceneChoice& choice);
/// How fast waves run through it, no less [m/s].
double wave_speed(const SceneChoice& choice);

}  // namespace pliant
