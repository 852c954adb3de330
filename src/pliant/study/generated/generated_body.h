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
/// "geometry: {...}, material: {...}" of the scene's first body.
std::string body_text(const SceneChoice& choice, const SceneUnits& units);

}  // namespace pliant
