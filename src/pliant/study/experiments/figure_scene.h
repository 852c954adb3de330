#pragma once

#include <string>

#include "pliant/study/experiments/particle_scene.h"

namespace pliant {

/// The closed figure of a file, filled with about so many particles.
BodyGeometry filled_figure(const std::string& file, double particles);
/// Between the particles that fill it [m].
double figure_spacing(const BodyGeometry& figure);
/// What bends the figure: its seat is held, and gravity comes from the side.
void bend_figure(ParticleScene& scene, double spacing);

}  // namespace pliant
