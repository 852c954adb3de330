#include "cuda/solvers/matrix/iteration_matrix.h"

#include <fmt/format.h>

#include "cuda/solvers/clusters/cluster_relaxation.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// Each is a launch, in which a few particles of a large cluster move at a time.
constexpr std::size_t kMostColors = 64;

void prepare_sweep(const ProjectiveSystem& system, int most, IterationMatrix& prepared) {
  prepared.coloring = color_vertices(prepared.matrix, system.particles, most);
  const std::size_t colors = prepared.coloring.colors.size();
  if (colors > kMostColors) {
    throw InputError(fmt::format(
        "a sweep over this body takes {} colours, on a GPU {} at the most; 'hybrid' bounds them",
        colors, kMostColors));
  }
  prepared.relaxation.gamma = prepared.relaxation.largest_eigenvalue = 1.0;
  prepared.relaxation.mobility = free_mobility(
      prepared.diagonal + overflow_row_sums(prepared.matrix, prepared.coloring), system.particles);
}

}  // namespace

IterationMatrix prepare_iteration(const ProjectiveSystem& system, double dt,
                                  const DeviceIteration& iteration) {
  IterationMatrix prepared;
  ClusterRelaxation known;
  if (iteration.kind == DeviceIteration::kJacobi && known.set(system, dt)) {
    prepared.relaxation = known.relaxation;
    prepared.diagonal = known.diagonal;
    return prepared;
  }
  prepared.matrix = projective_matrix(system, dt);
  prepared.diagonal = prepared.matrix.diagonal();
  if (iteration.kind == DeviceIteration::kSweep) {
    prepare_sweep(system, iteration.colors, prepared);
  } else {
    prepared.relaxation = make_relaxation(prepared.matrix, system.particles);
  }
  if (iteration.is_multigrid) {
    prepared.multigrid =
        std::make_shared<Multigrid>(prepared.matrix, prepared.relaxation.largest_eigenvalue);
  }
  return prepared;
}

PackedMatrix pack_matrix(const IterationMatrix& prepared, const DeviceIteration& iteration,
                         const Eigen::VectorXd& inertia, const PackedSystem& packed) {
  switch (iteration.kind) {
    case DeviceIteration::kLineSearch:
      return pack_whole(prepared.matrix, iteration, inertia, packed);
    case DeviceIteration::kQuasiNewton: {
      PackedMatrix result = pack_whole(prepared.matrix, iteration, inertia, packed);
      if (prepared.multigrid == nullptr) return result;
      const auto multigrid = std::make_shared<PackedMultigrid>(
          pack_multigrid(*prepared.multigrid, packed.order, packed.place));
      result.multigrids.push_back({multigrid, packed.blocks * packed.block});
      return result;
    }
    case DeviceIteration::kSweep:
      return pack_sweep(prepared.matrix, prepared.coloring, packed);
    case DeviceIteration::kJacobi:
      break;
  }
  return {};
}

}  // namespace pliant
