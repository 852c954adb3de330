#include "pliant/solvers/device/backend_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/elements/solids/tetrahedron_set.h"

namespace pliant {
namespace {

// One iteration of one thread [s].
constexpr double kSpring = 9e-9, kHinge = 17e-9, kOtherElement = 60e-9, kParticle = 33e-9;
// Of an iteration on the CPU, what one thread does; particles from which another one has work.
constexpr double kSerial = 0.15;
constexpr double kGrain = 4096.0;
// On the GPU: of a step, and of an iteration that fills it not nor waits for memory; then for each
// element and particle [s].
constexpr double kStep = 0.25e-3, kIteration = 9e-6, kOnDevice = 0.09e-9;
// Besides, of an iteration that reads the matrix: of its rows, for each element on one thread of
// the CPU, for each element and particle on the GPU; there of each launch, and of each colour [s].
constexpr double kRows = 8e-9, kRowsOnDevice = 0.015e-9, kLaunch = 2.5e-6, kColor = 3.6e-6;
// Of a sweep over cloth or tetrahedra, where nothing bounds their number.
constexpr int kColors = 10;
// Of lbfgs, beside an iteration of Jacobi: forces and energies on the CPU, where one thread solves
// with the factor, for each particle of a sheet, and of a solid times the cube root of their
// number; on the GPU its launches beside those of its sweeps, of all of which each takes so long
// [s], since sums among them wait for all that is before.
constexpr double kEvaluations = 3.0, kSheetSolve = 50e-9, kSolidSolve = 120e-9;
constexpr int kPairLaunches = 8;
constexpr double kPairLaunch = 4.1e-6;
// Of a multigrid cycle: launches of the finest level and what a block takes on the small ones, in
// launches; of each level of more rows than that; what it reads, in sweeps over the rows.
constexpr int kCycleLaunches = 14, kLevelLaunches = 6;
constexpr double kBlockRows = 2048.0, kCoarser = 9.0, kCycleSweeps = 7.0;
// What the host does for the GPU's step, by one thread, for each particle [s].
constexpr double kHost = 100e-9;

double cost_of(const ElementSet& set) {
  switch (set.cost_of_element()) {
    case ElementSet::Cost::kSpring:
      return kSpring;
    case ElementSet::Cost::kCell:
      return 2.0 * kSpring;  // two lengths
    case ElementSet::Cost::kHinge:
      return kHinge;
    case ElementSet::Cost::kOther:
      break;
  }
  return kOtherElement;
}

/// Of a cycle on a sheet, whose levels have a ninth of the rows each.
int cycle_launches(double particles) {
  int launches = kCycleLaunches;
  for (double rows = particles / kCoarser; rows > kBlockRows; rows /= kCoarser) {
    launches += kLevelLaunches;
  }
  return launches;
}

/// Of launches beyond the one of a Jacobi iteration [s]; 0: the iteration reads no matrix.
double more_launches(const ProjectiveSystem& system, const DeviceIteration& iteration) {
  switch (iteration.kind) {
    case DeviceIteration::kLineSearch:
      return 4 * kLaunch;
    case DeviceIteration::kSweep:
      // Colours but the first, the overflow of bounded ones, and the move.
      return kColor * (iteration.colors > 0 ? iteration.colors + 1 : kColors);
    case DeviceIteration::kQuasiNewton:
      return kPairLaunch *
             (kPairLaunches + (iteration.is_multigrid ? cycle_launches(system.particles.size())
                                                      : iteration.sweeps));
    case DeviceIteration::kJacobi:
      break;
  }
  return 0.0;
}

/// Of lbfgs: solutions with the factor of an iteration, by one thread [s].
double solve_with_factor(const ProjectiveSystem& system) {
  const double particles = system.particles.size();
  const bool is_solid = std::any_of(
      system.elements.begin(), system.elements.end(),
      [](const auto& set) { return set->size() > 0 && cost_of(*set) == kOtherElement; });
  return particles * (is_solid ? kSolidSolve * std::cbrt(particles) : kSheetSolve);
}

}  // namespace

DeviceIteration iteration_for(const DeviceIteration& wanted, const ProjectiveSystem& system) {
  const bool is_weighted = wanted.kind == DeviceIteration::kLineSearch;
  if (is_weighted && !system.constraints.empty()) return {};
  DeviceIteration iteration = wanted;
  const bool is_solid =
      std::any_of(system.elements.begin(), system.elements.end(),
                  [](const auto& set) { return set->size() > 0 && set->is_solid(); });
  if (is_solid && wanted.is_multigrid && wanted.solid_sweeps > 0) {
    iteration.is_multigrid = false;
    iteration.sweeps = wanted.solid_sweeps;
  }
  return iteration;
}

BackendEstimate estimate_step(const ProjectiveSystem& system, int iterations, int threads,
                              const DeviceIteration& wanted) {
  const DeviceIteration iteration = iteration_for(wanted, system);
  const double launches = more_launches(system, iteration);
  const bool reads_rows = launches > 0.0;
  const double particles = system.particles.size();
  double work = kParticle * particles, elements = 0.0;
  for (const auto& set : system.elements) {
    work += (cost_of(*set) + (reads_rows ? kRows : 0.0)) * set->size();
    elements += set->size();
  }
  const double busy = std::clamp(particles / kGrain, 1.0, static_cast<double>(threads));
  const double share = kSerial + (1.0 - kSerial) / busy;
  const bool has_pairs = iteration.kind == DeviceIteration::kQuasiNewton;
  const double sweeps = iteration.is_multigrid ? kCycleSweeps : iteration.sweeps;
  const double rows = has_pairs ? sweeps * kRowsOnDevice : kRowsOnDevice;
  const double each = kOnDevice + (reads_rows ? rows : 0.0);
  const double on_cpu =
      has_pairs ? kEvaluations * work * share + solve_with_factor(system) : work * share;
  return {iterations * on_cpu,
          kStep + iterations * (kIteration + launches + each * (elements + particles)) +
              kHost * particles * share};
}

std::string why_faster(const BackendEstimate& estimate) {
  const bool on_cpu = estimate.cpu <= estimate.cuda;
  return fmt::format("{:.2g} ms a step estimated beside {:.2g} ms on the {}",
                     1e3 * std::min(estimate.cpu, estimate.cuda),
                     1e3 * std::max(estimate.cpu, estimate.cuda), on_cpu ? "GPU" : "CPU");
}

}  // namespace pliant
