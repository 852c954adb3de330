#include "pliant/solvers/backend_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/elements/bending_set.h"
#include "pliant/elements/spring_set.h"

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
// the CPU and on the GPU, of each launch there [s].
constexpr double kRows = 8e-9, kRowsOnDevice = 0.05e-9, kLaunch = 2.5e-6;
// Colours that a sweep takes where nothing bounds them.
constexpr int kManyColors = 20;
// What the host does for the GPU's step, by one thread, for each particle [s].
constexpr double kHost = 100e-9;

double cost_of(const ElementSet& set) {
  if (dynamic_cast<const SpringSet*>(&set) != nullptr) return kSpring;
  if (dynamic_cast<const BendingSet*>(&set) != nullptr) return kHinge;
  return kOtherElement;
}

/// Launches of an iteration beyond the one of a Jacobi iteration; 0: it reads no matrix.
int more_launches(const ProjectiveSystem& system, const DeviceIteration& iteration) {
  switch (iteration.kind) {
    case DeviceIteration::kWeighted:
      return system.couplings.empty() ? 4 : 0;  // where there is contact: plain Jacobi
    case DeviceIteration::kSweep:
      return 1 + (iteration.colors > 0 ? iteration.colors : kManyColors);
    case DeviceIteration::kJacobi:
      break;
  }
  return 0;
}

}  // namespace

BackendEstimate estimate_step(const ProjectiveSystem& system, int iterations, int threads,
                              const DeviceIteration& iteration) {
  const int launches = more_launches(system, iteration);
  const double particles = system.particles.size();
  double work = kParticle * particles, elements = 0.0;
  for (const auto& set : system.elements) {
    work += cost_of(*set) * set->size();
    elements += set->size();
  }
  const double rows = launches > 0 ? elements : 0.0;
  work += kRows * rows;
  const double busy = std::clamp(particles / kGrain, 1.0, static_cast<double>(threads));
  const double share = kSerial + (1.0 - kSerial) / busy;
  return {iterations * work * share,
          kStep +
              iterations * (kIteration + kOnDevice * (elements + particles) + kLaunch * launches +
                            kRowsOnDevice * (rows + particles * (launches > 0))) +
              kHost * particles * share};
}

std::string why_faster(const BackendEstimate& estimate) {
  const bool on_cpu = estimate.cpu <= estimate.cuda;
  return fmt::format("{:.2g} ms a step estimated beside {:.2g} ms on the {}",
                     1e3 * std::min(estimate.cpu, estimate.cuda),
                     1e3 * std::max(estimate.cpu, estimate.cuda), on_cpu ? "GPU" : "CPU");
}

}  // namespace pliant
