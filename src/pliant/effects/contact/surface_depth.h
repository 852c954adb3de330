#pragma once

#include <vector>

#include "pliant/core/body/embedded_points.h"
#include "pliant/core/obstacle.h"
#include "pliant/core/step/step_report.h"
#include "pliant/effects/contact/contact_detection.h"

namespace pliant {

/// Contact keeps points of a body out of obstacles; between them its surface may sink in, the
/// deeper the softer the body and the sharper the obstacle. This looks how deep, and tells.
class SurfaceDepth {
 public:
  /// What is deeper than this share of the body's size is told.
  static constexpr double kTold = 0.02;

  /// `surface` outlives this; null: there is nothing between the points that touch.
  explicit SurfaceDepth(const EmbeddedPoints* surface) : surface_(surface) {}
  /// At the end of a step: warns where the surface is deep in what carries one of the `contacts`. A
  /// look asks the distance of every point of the surface, so that it is taken after each of a
  /// run's first steps and then after every eighth.
  void look(const Particles& particles, const std::vector<Obstacle>& obstacles,
            const std::vector<Contact>& contacts, StepReport& report) const;

 private:
  /// Of the deepest point in one obstacle [m].
  double depth(const Positions& x, const Obstacle& obstacle) const;
  /// Of the body, the longest side of its surface's box [m].
  double size(const Positions& x) const;

  const EmbeddedPoints* surface_;
};

}  // namespace pliant
