// Time of whole steps of particles between solid and liquid on a GPU, whose state stays there: SPH,
// clusters, blend. See docs/performance.md; scripts/bundle takes it to a bare GPU host.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "bench/cuda_timing.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/resident_blend.h"
#include "pliant/core/parallel.h"
#include "pliant/core/timer.h"
#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/primitive_shapes.h"
#include "pliant/models/solver_registry.h"
#include "pliant/models/viscoelastic/viscoelastic.h"

namespace pliant::bench {
namespace {

constexpr int kSteps = 40;

/// A cube of side^3 particles on a lattice, shaken a little, on the floor of a wide tank.
BodyGeometry cube(int side, double spacing) {
  BodyGeometry geometry;
  geometry.interior_points.resize(3, side * side * side);
  std::uint64_t state = 1;
  const auto random = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
  };
  for (int i = 0; i < side * side * side; ++i) {
    const Eigen::Vector3d cell(i % side, i / side % side, i / (side * side));
    for (int k = 0; k < 3; ++k) {
      geometry.interior_points(k, i) = spacing * (cell[k] + 0.5 + 0.1 * random());
    }
  }
  geometry.volume = std::pow(side * spacing, 3);
  return geometry;
}

/// Bytes of an iteration, each number once.
double bytes_of_iteration(const PackedSystem& packed, const ClusterTable& table) {
  double bytes = 4.0 * static_cast<double>(table.members.size() + table.pull_clusters.size());
  bytes += 16.0 * static_cast<double>(table.loads.size() + table.pull_loads.size());
  // Owner, origin, stiffness, frame, rotation, read and written, centre; the last three again.
  bytes += table.clusters * (12.0 + 16.0 + 32.0 + 16.0 + 48.0);
  // x and rest, twice; the prediction, the iterate before, mobility; x is written.
  return bytes + packed.particles * (32.0 + 32.0 + 16.0 + 16.0 + 4.0 + 16.0);
}

/// Of the liquid's sums: sorting, what ranks copy, density, forces.
double bytes_of_liquid(int particles) {
  return particles * (3.0 * 16.0 + 12.0 + 64.0 + 24.0 + 52.0);
}

struct Times {
  std::vector<double> liquid, predict, iterate, finish, all;
};

class Events {
 public:
  Events() {
    for (auto& event : events_) check_cuda(cudaEventCreate(&event), "event");
  }
  ~Events() {
    for (auto& event : events_) cudaEventDestroy(event);
  }
  void record(int number, cudaStream_t stream) {
    check_cuda(cudaEventRecord(events_[number], stream), "event");
  }
  void wait(int number) { check_cuda(cudaEventSynchronize(events_[number]), "event"); }
  double seconds(int from, int to) {
    float milliseconds = 0.0f;
    check_cuda(cudaEventElapsedTime(&milliseconds, events_[from], events_[to]), "event");
    return 1e-3 * milliseconds;
  }

 private:
  cudaEvent_t events_[5] = {};
};

Times measure(ResidentBlend<CudaExecutor>& blend, bool flows) {
  Times times;
  Events events;
  cudaStream_t stream = blend.executor().stream();
  for (int s = 0; s < kSteps + 5; ++s) {
    events.record(0, stream);
    if (flows) blend.push_liquid();
    events.record(1, stream);
    blend.predict();
    events.record(2, stream);
    blend.iterate();
    events.record(3, stream);
    blend.finish();
    events.record(4, stream);
    events.wait(4);
    if (s < 5) continue;  // the first ones warm up
    times.liquid.push_back(events.seconds(0, 1));
    times.predict.push_back(events.seconds(1, 2));
    times.iterate.push_back(events.seconds(2, 3));
    times.finish.push_back(events.seconds(3, 4));
    times.all.push_back(events.seconds(0, 4));
  }
  return times;
}

constexpr double kSpacing = 0.1;  // so that a step of 1/75 s is stable [m]

ViscoelasticModel::Material material_of(double beta, double fraction) {
  ViscoelasticModel::Material material;
  material.beta = beta;
  material.solid.cluster_fraction = fraction;
  return material;
}

double time_step(const ViscoelasticModel& model) {
  return std::min(1.0 / 60.0, model.system().liquid.stable_step(1.0));
}

void run(int side, double fraction, double beta, int iterations, double bandwidth) {
  const Timer setup;
  const BodyGeometry geometry = cube(side, kSpacing);
  ViscoelasticModel model(geometry, material_of(beta, fraction));
  ResidentBlend<CudaExecutor>::Options options;
  options.dt = time_step(model);
  options.gravity = {0.0, 0.0, -9.81};
  options.iterations = iterations;
  const double length = side * kSpacing;
  options.walls = {{0, 0, 1, 0},
                   {1, 0, 0, -length},
                   {-1, 0, 0, -2 * length},
                   {0, 1, 0, -length},
                   {0, -1, 0, -2 * length}};
  ResidentBlend<CudaExecutor> blend(model.system(), options);
  std::fprintf(stderr, "set up in %.1f s\n", setup.seconds());
  const bool flows = beta > 0.0;
  const Times times = measure(blend, flows);
  Positions x, v;
  blend.download(x, v);
  const int n = side * side * side;
  const ClusterTable table =
      lay_out(blend.packed().clusters, n, ClusterArrays<CudaExecutor>::kChunk);
  const double all = median(times.all), liquid = median(times.liquid),
               each = median(times.iterate) / iterations;
  fmt::print(
      "{},{},{},{},{},{:.4f},{:.3f},{:.3f},{:.1f},{:.2f},{:.2f},{:.1f},{:.1f},{:.1f},{},{}\n", n,
      beta, blend.packed().clusters.size(), table.members.size(), iterations, options.dt, 1e3 * all,
      1e3 * liquid, 1e6 * each, 1e3 * *std::min_element(times.all.begin(), times.all.end()),
      1e3 * *std::max_element(times.all.begin(), times.all.end()), 1.0 / all,
      flows ? 1e-6 * n / liquid : 0.0,
      flows ? 100.0 * bytes_of_liquid(n) / liquid / bandwidth : 0.0,
      100.0 * bytes_of_iteration(blend.packed(), table) / each / bandwidth,
      blend.control().done_at);
  std::fflush(stdout);
  if (!x.allFinite()) std::fprintf(stderr, "not finite\n");
}

/// The same body in a scene, whose state the CPU holds: each step is uploaded and downloaded.
void run_scene(int side, double fraction, double beta, int iterations) {
  const BodyGeometry geometry = cube(side, kSpacing);
  auto model = std::make_unique<ViscoelasticModel>(geometry, material_of(beta, fraction));
  World world(time_step(*model));
  Obstacle floor;
  floor.name = "floor";
  floor.shape = std::make_shared<Plane>();
  floor.pose_start = floor.pose_end = Eigen::Isometry3d::Identity();
  world.add_obstacle(floor);
  Body& body = world.add_body("body", std::move(model));
  for (const char* effect : {"gravity", "contact"}) {
    world.add_effect(body, effect_registry(), effect, {}, effect);
  }
  world.set_initial_state();
  world.set_solver(body, all_solvers(), "chebyshev",
                   {{"iterations", std::to_string(iterations)}, {"backend", "cuda"}}, "bench");
  std::vector<double> times;
  for (int s = 0; s < 15; ++s) {
    const Timer timer;
    if (!world.step()) throw InputError(world.failure());
    if (s >= 5) times.push_back(timer.seconds());
  }
  const double each = median(times);
  fmt::print("scene,{},{},{},{:.1f} ms,{:.1f} steps/s,{} threads", side * side * side, beta,
             fraction, 1e3 * each, 1.0 / each, threads());
  for (const PhaseTime& phase : body.report.phases) {
    fmt::print(",{} {:.1f}", phase.name, 1e3 * phase.seconds);
  }
  for (const std::string& warning : body.report.warnings) fmt::print(",{}", warning);
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  CLI::App app("Times steps of particles on a GPU: SPH, clusters, blend");
  std::vector<int> sides = {100};
  std::vector<double> fractions = {1.0}, betas = {0.5};
  int iterations = 20, threads = 1;
  bool scene = false;
  app.add_option("--threads", threads, "of the CPU");
  app.add_flag("--scene", scene, "in a scene, whose state the CPU holds");
  app.add_option("--sides", sides, "cubes of so many particles along an edge");
  app.add_option("--fractions", fractions, "of the particles that are centres of clusters");
  app.add_option("--betas", betas, "0 solid to 1 liquid");
  app.add_option("--iterations", iterations, "of Chebyshev's method a step");
  CLI11_PARSE(app, argc, argv);
  const std::string reason = pliant::why_no_gpu();
  if (!reason.empty()) {
    std::fprintf(stderr, "cuda_particles_bench: no usable GPU: %s\n", reason.c_str());
    return 1;
  }
  try {
    pliant::set_threads(threads);
    const double bandwidth = pliant::bench::copy_bandwidth();
    fmt::print("device,{}\ncopy_bandwidth_TB_s,{:.3f}\n", pliant::gpu_name(), 1e-12 * bandwidth);
    fmt::print(
        "particles,beta,clusters,members,iterations,dt_s,step_ms,liquid_ms,iteration_us,least_ms,"
        "most_ms,steps_per_s,million_sph_particle_steps_per_s,liquid_percent_of_copy,"
        "iteration_percent_of_copy,done_at\n");
    for (int side : sides) {
      for (double fraction : fractions) {
        for (double beta : betas) {
          if (scene) {
            pliant::bench::run_scene(side, fraction, beta, iterations);
          } else {
            pliant::bench::run(side, fraction, beta, iterations, bandwidth);
          }
        }
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cuda_particles_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
