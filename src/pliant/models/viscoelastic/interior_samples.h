#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Points that fill a body.
struct InteriorSamples {
  Eigen::Matrix3Xd points;  ///< 3 x n [m]
  double volume = 0.0;      ///< of the body [m³]; each point stands for an n-th of it
};

/// Fills a closed mesh with points about `spacing` apart: one at random in each cell of a lattice,
/// then spread evenly by repelling each other and their mirror images behind the surface. So they
/// are as even as a crystal at a distance, with none of its directions. The same points each time.
/// Throws InputError for a mesh that is open or too thin, a spacing that is not positive, or more
/// than 2 million points.
InteriorSamples sample_interior(const TriangleMesh& mesh, double spacing);

/// The least spacing that sample_interior() takes for the extents of a mesh; 0 of an empty one.
double least_particle_spacing(const TriangleMesh& mesh);

}  // namespace pliant
