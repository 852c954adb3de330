// Time of whole steps of a scene of particles between solid and liquid on a GPU, whose state stays
// there: SPH, clusters, walls, contact, blend. See docs/performance.md; scripts/bundle takes it to
// a bare GPU host.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "bench/cuda_timing.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/blend_resident_run.h"
#include "cuda/solvers/scenes/device_solver.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/core/step/timer.h"
#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/shortest_turn.h"
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

/// Of single phases of a step, each a graph; what the resident run holds goes on meanwhile.
Times measure(DeviceResidentRun<CudaExecutor>& run, int iterations) {
  Times times;
  Events events;
  CudaExecutor& executor = run.step().executor();
  const CudaExecutor::Graph phases[] = {
      executor.capture([&] { run.launch_forces(1); }),
      executor.capture([&] { run.launch_prediction(); }),
      executor.capture([&] { run.step().launch_iterations(iterations); }),
      executor.capture([&] { run.launch_end(1); })};
  for (int s = 0; s < kSteps + 5; ++s) {
    events.record(0, executor.stream());
    for (int k = 0; k < 4; ++k) {
      executor.replay(phases[k]);
      events.record(k + 1, executor.stream());
    }
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

constexpr double kSpacing = 0.1;  // [m]

ViscoelasticModel::Material material_of(double beta, double fraction) {
  ViscoelasticModel::Material material;
  material.beta = beta;
  material.solid.cluster_fraction = fraction;
  return material;
}

/// So short that no step needs substeps, however fast the cube falls apart.
double time_step(const ViscoelasticModel& model) {
  constexpr double kFastest = 10.0;  // [m/s]
  return std::min(1.0 / 60.0, model.system().liquid.stable_step(kFastest));
}

/// On the floor of a wider tank.
std::unique_ptr<World> make_scene(int side, double fraction, double beta) {
  auto model =
      std::make_unique<ViscoelasticModel>(cube(side, kSpacing), material_of(beta, fraction));
  auto world = std::make_unique<World>(time_step(*model));
  const double length = side * kSpacing;
  const auto add_wall = [&](const Eigen::Vector3d& normal, const Eigen::Vector3d& on) {
    Obstacle wall;
    wall.name = "wall";
    wall.shape = std::make_shared<Plane>();
    wall.pose_end.linear() = shortest_turn(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
    wall.pose_end.translation() = on;
    wall.pose_start = wall.pose_end;
    world->add_obstacle(wall);
  };
  add_wall({0, 0, 1}, {0, 0, 0});
  for (int axis = 0; axis < 2; ++axis) {
    add_wall(Eigen::Vector3d::Unit(axis), -length * Eigen::Vector3d::Unit(axis));
    add_wall(-Eigen::Vector3d::Unit(axis), 2.0 * length * Eigen::Vector3d::Unit(axis));
  }
  Body& body = world->add_body("body", std::move(model));
  for (const char* effect : {"gravity", "contact"}) {
    world->add_effect(body, effect_registry(), effect, {}, effect);
  }
  world->set_initial_state();
  return world;
}

void check(bool went_well, const World& world) {
  if (!went_well) throw InputError(world.failure());
}

/// Steps that nobody observes, as `pliant run` takes them: what a step of a resident run consists
/// of, and the wall time of whole runs, with all that goes up and down.
void run(int side, double fraction, double beta, int iterations, double bandwidth) {
  const Timer setup;
  const auto world = make_scene(side, fraction, beta);
  Body& body = world->bodies().front();
  DeviceSolverSpec spec;
  spec.name = "chebyshev";
  spec.rule.iterations = iterations;
  spec.is_accelerated = true;
  spec.delay = 5;
  auto made = std::make_unique<DeviceSolver<CudaExecutor>>(
      spec, nullptr, [] { return std::make_shared<BlendResidentRun<CudaExecutor>>(); });
  DeviceSolver<CudaExecutor>& solver = *made;
  body.solver = std::move(made);
  body.solver_dt = world->time_step();
  world->system_changed();
  check(world->step(), *world);
  check(world->advance(kSteps), *world);
  if (solver.resident_run() == nullptr) throw InputError("the scene takes no resident runs");
  std::fprintf(stderr, "set up in %.1f s\n", setup.seconds());
  std::vector<double> resident_times;
  for (int s = 0; s < 3; ++s) {
    const Timer timer;
    check(world->advance(kSteps), *world);
    resident_times.push_back(timer.seconds() / kSteps);
  }
  const bool flows = beta > 0.0;
  const Times times = measure(*solver.resident_run(), iterations);
  const int n = side * side * side;
  const PackedSystem packed =
      pack(static_cast<const ProjectiveSystem&>(body.model->system()), n >= 40000 ? 128 : 64);
  const ClusterTable table = lay_out(packed.clusters, n, ClusterArrays<CudaExecutor>::kChunk);
  const double all = median(times.all), liquid = median(times.liquid),
               each = median(times.iterate) / iterations, resident = median(resident_times);
  fmt::print(
      "{},{},{},{},{},{:.4f},{:.3f},{:.3f},{:.1f},{:.2f},{:.2f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},"
      "{}\n",
      n, beta, packed.clusters.size(), table.members.size(), iterations, world->time_step(),
      1e3 * all, 1e3 * liquid, 1e6 * each,
      1e3 * *std::min_element(times.all.begin(), times.all.end()),
      1e3 * *std::max_element(times.all.begin(), times.all.end()), 1.0 / all, 1.0 / resident,
      flows ? 1e-6 * n / liquid : 0.0,
      flows ? 100.0 * bytes_of_liquid(n) / liquid / bandwidth : 0.0,
      100.0 * bytes_of_iteration(packed, table) / each / bandwidth, body.report.iterations);
  std::fflush(stdout);
}

/// The surface that is drawn: by the CPU, and by the GPU with what goes up and down.
void run_surface(int side) {
  const BodyGeometry geometry = cube(side, kSpacing);
  const Eigen::Matrix3Xd& x = geometry.interior_points;
  const Eigen::VectorXd volumes =
      Eigen::VectorXd::Constant(x.cols(), geometry.volume / static_cast<double>(x.cols()));
  const SurfaceStyle style = {2.0 * std::cbrt(volumes[0]), 2, false};
  double seconds[2] = {0.0, 0.0};
  ParticleSurface surfaces[2];
  surfaces[1].set_device(make_cuda_surface());
  for (int on_device = 0; on_device < 2; ++on_device) {
    std::vector<double> times;
    for (int k = 0; k < 8; ++k) {
      const Timer timer;
      surfaces[on_device].update(x, volumes, style);
      if (k >= 3) times.push_back(timer.seconds());
    }
    seconds[on_device] = median(times);
  }
  const TriangleMesh &cpu = surfaces[0].mesh(), &gpu = surfaces[1].mesh();
  const bool is_same = cpu.triangles.cols() == gpu.triangles.cols() &&
                       (cpu.triangles.array() == gpu.triangles.array()).all();
  fmt::print("surface,{},{} triangles,CPU {:.1f} ms of {} threads,GPU {:.1f} ms,{}\n", x.cols(),
             gpu.triangles.cols(), 1e3 * seconds[0], threads(), 1e3 * seconds[1],
             is_same ? "the same triangles" : "other triangles");
  std::fflush(stdout);
}

/// Steps that are observed: each is uploaded and downloaded.
void run_single(int side, double fraction, double beta, int iterations) {
  const auto world = make_scene(side, fraction, beta);
  Body& body = world->bodies().front();
  world->set_solver(body, all_solvers(), "chebyshev",
                    {{"iterations", std::to_string(iterations)}, {"backend", "cuda"}}, "bench");
  std::vector<double> times;
  for (int s = 0; s < 15; ++s) {
    const Timer timer;
    check(world->step(), *world);
    if (s >= 5) times.push_back(timer.seconds());
  }
  const double each = median(times);
  fmt::print("single,{},{},{},{:.1f} ms,{:.1f} steps/s,{} threads", side * side * side, beta,
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
  bool single = false, surface = false;
  app.add_option("--threads", threads, "of the CPU");
  app.add_flag("--single", single, "steps that are observed, one by one");
  app.add_flag("--surface", surface, "the surface that is drawn, instead of steps");
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
        "most_ms,steps_per_s,resident_steps_per_s,million_sph_particle_steps_per_s,"
        "liquid_percent_of_copy,iteration_percent_of_copy,done_at\n");
    for (int side : sides) {
      if (surface) {
        pliant::bench::run_surface(side);
        continue;
      }
      for (double fraction : fractions) {
        for (double beta : betas) {
          if (single) {
            pliant::bench::run_single(side, fraction, beta, iterations);
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
