#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"
#include "pliant/models/viscoelastic/surface_blocks.h"

namespace pliant {

/// Where a surface about particles lies, as shares of what they fill.
struct SurfaceLimits {
  static constexpr float kLevel = 0.5f;
  /// A particle is at the boundary where its surroundings are filled less than this, or lie further
  /// to one side than this share of the support.
  static constexpr float kFull = 0.93f;
  static constexpr float kAside = 0.08f;
  /// Where a particle's place is filled less than this, as in a film one particle thick, it counts
  /// for more until it is: films and threads do not vanish.
  static constexpr float kThin = 0.65f;
};

/// Makes what ParticleSurface makes of round kernels elsewhere: the same polygons up to rounding.
/// Throws DeviceFailure.
class SurfaceDevice {
 public:
  virtual ~SurfaceDevice() = default;
  /// Takes the particles of `cells`, whose edge is the kernels' support, with their `weights`
  /// V W(0) by rank, and tells which cells hold one at the boundary. False, and nothing changed,
  /// where they lie too far apart.
  virtual bool weigh(const NeighborLists& cells, const Eigen::VectorXf& weights,
                     std::vector<char>& at_boundary) = 0;
  /// Of the particles of the last weigh(), as BlockPolygons makes them.
  virtual void make(const NeighborLists& cells, const SurfaceBlocks& blocks,
                    std::vector<Eigen::Vector3d>& vertices,
                    std::vector<Eigen::Vector3i>& triangles) = 0;
};

/// On the GPU. Throws DeviceFailure where there is none.
std::unique_ptr<SurfaceDevice> make_cuda_surface();

/// What the CUDA backend makes it by (solvers/device/cuda_library.h).
using MakeCudaSurface = void(std::unique_ptr<SurfaceDevice>& surface);
constexpr const char* kMakeCudaSurface = "pliant_cuda_surface";

}  // namespace pliant
