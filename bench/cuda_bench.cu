// Time of an iteration of the CUDA backend beside what the GPU's memory gives in the same run, and
// time to a given error; and of the search for what touches of a cloth. See docs/performance.md;
// scripts/bundle takes it to a bare GPU host.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string_view>

#include "bench/cuda_timing.cuh"
#include "bench/sheet_search_timing.h"
#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/solvers/device_step.h"
#include "cuda/solvers/matrix/iteration_matrix.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/math/error.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "pliant/scene/scene.h"
#include "pliant/solvers/iterations/lbfgs.h"
#include "pliant/solvers/registry.h"

namespace pliant::bench {
namespace {

constexpr double kStep = 1.0 / 60.0;  // [s]
constexpr int kIterations = 37;       // of a step that is timed: 1, 4 and four intervals

struct Body {
  std::string name;
  ProjectiveSystem system;
  double elements = 0.0;
  double bytes = 0.0;  ///< of an iteration, as the goal counts them
};

/// A box of cells of five tetrahedra, stretched and shaken.
Body solid(const Eigen::Vector3i& cells, double young) {
  BlockOptions options;
  options.size = cells.cast<double>() / cells.maxCoeff();
  options.cells = cells;
  const TetrahedralMesh mesh = make_block(options);
  Body body;
  body.name = fmt::format("tetrahedra_{}", mesh.tetrahedra.cols());
  body.elements = static_cast<double>(mesh.tetrahedra.cols());
  body.system.particles = Particles(mesh.vertices, 1000.0 * vertex_volumes(mesh));
  body.system.elements.push_back(
      std::make_unique<TetrahedronSet>(mesh, lame_parameters({young, 0.3, 1000.0})));
  body.bytes = 168.0 * body.elements + 88.0 * static_cast<double>(mesh.vertices.cols());
  return body;
}

/// A cloth of side x side particles with the springs and bending of the model `cloth`.
Body cloth(int side) {
  const GridOptions grid{1.0, 1.0, side, side};
  const TriangleMesh mesh = make_grid(grid);
  std::vector<Spring> springs = grid_stretch_springs(grid, {500.0, 500.0, 0.0});
  const std::vector<Spring> shear = grid_shear_springs(grid, 50.0, 2);
  springs.insert(springs.end(), shear.begin(), shear.end());
  Body body;
  body.name = fmt::format("cloth_{}", side * side);
  body.elements = static_cast<double>(springs.size());
  body.system.particles = Particles(mesh.vertices, 0.15 * vertex_areas(mesh));
  body.system.elements.push_back(
      std::make_unique<SpringSet>("stretch", springs, body.system.particles.size()));
  body.system.elements.push_back(std::make_unique<BendingSet>(grid, 1e-5, 1e-5));
  return body;
}

void shake(Body& body, double amount) {
  Particles& particles = body.system.particles;
  std::uint64_t state = 1;
  for (Eigen::Index k = 0; k < particles.x.size(); ++k) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    particles.x.data()[k] += amount * (static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5);
  }
}

/// What a cycle moves: the finest matrix four times and once more with each sweep's vectors,
/// coarser ones likewise, interpolation both ways.
double cycle_bytes(const PackedSystem& packed) {
  const PackedMultigrid& multigrid = *packed.matrix.multigrids.front().packed;
  double bytes = 3.0 * 8.0 * static_cast<double>(packed.matrix.rows.neighbors.size()) +
                 8.0 * static_cast<double>(multigrid.prolongation.neighbors.size()) +
                 packed.particles * (4.0 * 88.0 + 48.0);
  for (const PackedLevel& level : multigrid.levels) {
    bytes += 32.0 * static_cast<double>(level.matrix.neighbors.size()) +
             8.0 * static_cast<double>(level.restriction.neighbors.size() +
                                       level.prolongation.neighbors.size()) +
             level.rows * (4.0 * 80.0 + 100.0);
  }
  return bytes;
}

/// What an iteration really moves, each number once.
double packed_bytes(const PackedSystem& packed) {
  double bytes = 0.0;
  for (const PackedSimplices* s : {&packed.tetrahedra, &packed.fibers, &packed.triangles}) {
    const double rotations = s->corners == 4 ? 16.0 : 0.0;
    bytes += static_cast<double>(s->size()) * (8.0 + 8.0 + 16.0 * s->quads + rotations);
  }
  bytes += 10.0 * static_cast<double>(packed.springs.neighbors.size());
  bytes += 6.0 * static_cast<double>(packed.quadratic.neighbors.size());
  bytes += 20.0 * static_cast<double>(packed.borders.places().size());
  bytes += 8.0 * static_cast<double>(packed.matrix.rows.neighbors.size());
  if (packed.matrix.kind == DeviceIteration::kQuasiNewton) {
    // Each sweep reads the rows, z, the one before, q, mobility, inertia and z again; then pairs.
    const double sweeps = packed.matrix.sweeps - 1, pairs = packed.matrix.history;
    bytes += packed.particles * (pairs * 80.0 + 200.0);
    if (!packed.matrix.multigrids.empty()) {
      bytes += cycle_bytes(packed);
    } else {
      bytes += (sweeps - 1.0) * 8.0 * static_cast<double>(packed.matrix.rows.neighbors.size());
      bytes += packed.particles * sweeps * 88.0;
    }
  } else if (packed.matrix.kind != DeviceIteration::kJacobi) {
    bytes += 80.0 * packed.particles;
  }
  // x, y, the one before, mobility, slots; x is written.
  return bytes + packed.particles * (16.0 + 16.0 + 16.0 + 4.0 + 4.0 + 16.0);
}

/// What a solver's iterations do, its parameters being those that it has by default.
DeviceIteration iteration_of(const std::string& solver) {
  if (solver == "line_search_jacobi") return {DeviceIteration::kLineSearch, 2.0};
  if (solver == "gauss_seidel") return {DeviceIteration::kSweep, 1.0, 0};
  if (solver == "hybrid") return {DeviceIteration::kSweep, 1.0, 8};
  if (solver == "lbfgs") return lbfgs_device_spec({}, 5).iteration;
  if (solver == "lbfgs_chebyshev") return lbfgs_device_spec({}, 5, 16).iteration;
  return {};
}

/// Of Jacobi iterations a bound that takes no search for an eigenvalue.
Eigen::VectorXd mobility_of(const ProjectiveSystem& system, const IterationMatrix& prepared) {
  if (prepared.relaxation.mobility.size() > 0) return prepared.relaxation.mobility;
  AbsoluteRowSums sums(system.particles.size());
  for (const auto& set : system.elements) set->add_to_system(sums);
  return (system.particles.mass / (kStep * kStep) + sums.sums()).cwiseInverse();
}

StepRules rules_of(const ProjectiveSystem& system, const DeviceIteration& iteration,
                   double quantum) {
  StepRules rules;
  rules.quantum = static_cast<float>(quantum);
  rules.particles = system.particles.size();
  rules.spread = static_cast<float>(iteration.spread);
  rules.keeps_best = iteration.kind == DeviceIteration::kJacobi;
  rules.is_accelerated = rules.keeps_best;
  rules.rho = 0.99;
  rules.rho_bound = 0.999;
  rules.delay = 5;
  // As of a body far stiffer than its inertia.
  rules.largest_eigenvalue = 2.0f;
  rules.least_eigenvalue =
      iteration.sweeps > 0 ? 1.5f / (iteration.sweeps * iteration.sweeps) : 1.0f;
  if (iteration.is_multigrid) rules.least_eigenvalue = 2.0f / Smoother::kRange;
  return rules;
}

struct Timed {
  double median, least, most;  ///< of an iteration [s]
  int done_at;
  double packed_bytes;
};

/// Steps of a solver's iterations with their control, over their number.
Timed time_iterations(const ProjectiveSystem& system, const std::string& solver, int block,
                      int threads, int passes) {
  const Particles& particles = system.particles;
  const DeviceIteration iteration = iteration_of(solver);
  const Eigen::VectorXd inertia = particles.mass / (kStep * kStep);
  IterationMatrix prepared;
  if (iteration.kind != DeviceIteration::kJacobi) {
    prepared = prepare_iteration(system, kStep, iteration);
  }
  PackedSystem packed = pack(system, block, passes);
  packed.matrix = pack_matrix(prepared, iteration, inertia, packed);
  DeviceStep<CudaExecutor> step(packed, threads);
  const Eigen::VectorXd mobilities = mobility_of(system, prepared);
  std::vector<float> mobility(packed.order.size());
  std::vector<Fixed> y(packed.order.size());
  constexpr double kQuantum = 1.0 / (1 << 28);
  for (std::size_t k = 0; k < y.size(); ++k) {
    const int i = packed.order[k];
    mobility[k] = static_cast<float>(mobilities[i]);
    const auto at = (particles.x.col(i) / kQuantum).eval();
    y[k] = {static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]),
            static_cast<float>(inertia[i])};
  }
  step.set_mobility(mobility);
  step.set_predicted(y);
  step.set_start(y);
  step.set_contacts(ContactTable());
  step.set_rules({rules_of(system, iteration, kQuantum)});
  const auto graph = step.executor().capture([&] { step.launch_iterations(kIterations); });
  const auto times = replay_times(step.executor(), graph, 50);
  return {median(times) / kIterations, *std::min_element(times.begin(), times.end()) / kIterations,
          *std::max_element(times.begin(), times.end()) / kIterations,
          step.control().front().done_at, packed_bytes(packed)};
}

void measure_iterations(Body body, const std::string& solver, int block, int threads, int passes,
                        double bandwidth) {
  shake(body, 1e-3);
  const Timed it = time_iterations(body.system, solver, block, threads, passes);
  fmt::print("{},{},{},{:.0f},{},{},{},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{}\n", body.name, solver,
             body.system.particles.size(), body.elements, block, threads, kIterations,
             1e6 * it.median, 1e6 * it.least, 1e6 * it.most,
             body.bytes > 0.0 ? 100.0 * body.bytes / it.median / bandwidth : 0.0,
             100.0 * it.packed_bytes / it.median / bandwidth, it.done_at);
  std::fflush(stdout);
}

void iterations(const std::vector<int>& cells, const std::vector<int>& lengths,
                const std::vector<int>& sides, const std::vector<int>& blocks,
                const std::vector<int>& threads, const std::vector<std::string>& solvers,
                int passes) {
  const double bandwidth = copy_bandwidth();
  fmt::print("device,{}\ncopy_bandwidth_TB_s,{:.3f}\n", gpu_name(), 1e-12 * bandwidth);
  fmt::print(
      "body,solver,particles,elements,block,threads_per_particle,iterations,microseconds,least,"
      "most,percent_of_copy_as_counted,percent_of_copy_as_packed,done_at\n");
  for (int block : blocks) {
    for (const std::string& solver : solvers) {
      for (int each : threads) {
        for (int count : lengths) {
          measure_iterations(solid({6, 6, count}, 1e5), solver, block, each, passes, bandwidth);
        }
        for (int count : cells) {
          measure_iterations(solid(Eigen::Vector3i::Constant(count), 1e5), solver, block, each,
                             passes, bandwidth);
        }
      }
      for (int side : sides) {
        measure_iterations(cloth(side), solver, block, 1, passes, bandwidth);
      }
    }
  }
}

std::unique_ptr<Solver> make_solver(const std::string& name, ParameterText parameters) {
  const auto& entry = solver_registry().find(name);
  return entry.make(parse_parameters(entry.parameters, parameters, "bench"));
}

/// Time of the iterations alone: without the way to the GPU and back, what is learned once, and
/// what is found out beside them, each step here being the first of a run.
double iteration_seconds(const StepReport& report) {
  static const std::set<std::string_view> others = {
      "upload",   "download",        "prepare",      "predict",       "velocity",
      "momentum", "spectral_radius", "energy_guard", "error_estimate"};
  double sum = 0.0;
  for (const PhaseTime& phase : report.phases) {
    if (others.count(phase.name) == 0) sum += phase.seconds;
  }
  return sum;
}

struct Run {
  const char* solver;
  const char* backend;
  std::vector<int> iterations;
};

/// Errors of one step from where the system is, over the way that it goes from its prediction, and
/// the time of its iterations.
void compare(ProjectiveSystem& system, double dt, const std::string& name,
             const std::vector<Run>& runs) {
  Particles& particles = system.particles;
  const Particles start = particles;
  const Forces external = system.external_forces;
  const auto step = [&](Solver& solver) {
    particles = start;
    system.external_forces = external;
    StepReport report;
    report.begin(1, dt, dt);
    solver.step(system, dt, report);
    return report;
  };
  const auto reference = make_solver("lbfgs", {{"iterations", "400"}, {"tolerance", "1e-10"}});
  reference->prepare(system, dt);
  const StepReport told = step(*reference);
  const Positions exact = particles.x;
  Positions predicted = start.x + dt * start.v;
  for (int i = 0; i < particles.size(); ++i) {
    if (!start.is_fixed(i)) predicted.col(i) += dt * dt / start.mass[i] * external.col(i);
  }
  const double way = (exact - predicted).norm();
  fmt::print("# reference: residual {:.1e} after {}\n", told.residual, told.iterations);
  for (const Run& run : runs) {
    for (int count : run.iterations) {
      const auto solver = make_solver(run.solver, [&] {
        ParameterText text = {{"iterations", std::to_string(count)}};
        if (std::string(run.backend) == "cuda") text["backend"] = run.backend;
        return text;
      }());
      solver->prepare(system, dt);
      std::vector<double> times;
      StepReport report;
      for (int k = 0; k < 5; ++k) {
        report = step(*solver);
        if (k > 0) times.push_back(iteration_seconds(report));
      }
      fmt::print("{},{},{},{},{:.3e},{:.4f}\n", name, run.solver, report.backend, count,
                 (particles.x - exact).norm() / way, 1e3 * median(times));
      std::fflush(stdout);
    }
  }
  particles = start;
  system.external_forces = external;
}

void accuracy(int cells, int threads) {
  set_threads(threads);
  const std::vector<int> many = {5, 10, 20, 40, 80, 160, 320, 640, 1280, 2560};
  const std::vector<int> most = {5,   10,  20,   40,   80,   160,
                                 320, 640, 1280, 2560, 5120, 10240};  // where stiff bodies end
  const std::vector<Run> runs = {{"jacobi", "cuda", most},
                                 {"line_search_jacobi", "cuda", many},
                                 {"hybrid", "cuda", many},
                                 {"chebyshev", "cuda", many},
                                 {"lbfgs", "cuda", {1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64}},
                                 {"chebyshev", "cpu", {10, 20, 40, 80, 160}},
                                 {"lbfgs", "cpu", {2, 4, 8, 16, 32}},
                                 {"direct", "cpu", {1, 2, 4, 8, 16, 32, 64}}};
  fmt::print("young,solver,backend,iterations,error,milliseconds\n");
  for (double young : {1e4, 1e5, 1e6}) {
    Body body = solid(Eigen::Vector3i::Constant(cells), young);
    Particles& particles = body.system.particles;
    for (int i = 0; i < particles.size(); ++i) {
      const Eigen::Vector3d x = particles.x.col(i);
      if (x[0] < -0.499) particles.fix(i);
      particles.v.col(i) = Eigen::Vector3d(0.5, x[2], -x[1]) * 2.0 * (x[0] + 0.5);
    }
    body.system.external_forces =
        particles.mass.transpose().replicate(3, 1).array().colwise() * Eigen::Array3d(0, 0, -9.81);
    compare(body.system, kStep, fmt::format("{}", young), runs);
  }
}

/// The share of an iteration that goes to the local step, the elements' rotations and forces: what
/// an iteration of a system without elements does not take.
void print_local_share(const ProjectiveSystem& system, const std::string& name) {
  ProjectiveSystem bare;
  bare.particles = system.particles;
  constexpr int kBlock = 128, kThreads = 4;
  const double whole = time_iterations(system, "chebyshev", kBlock, kThreads, 1).median;
  const double rest = time_iterations(bare, "chebyshev", kBlock, kThreads, 1).median;
  fmt::print("# local step, {}: {:.3f} of {:.3f} microseconds, {:.0f} %\n", name,
             1e6 * (whole - rest), 1e6 * whole, 100.0 * (1.0 - rest / whole));
}

/// The paper's figures of the only body of scenes: after 0.2 s a step's error against iterations
/// and time, and the share of its local step.
void figures(const std::vector<std::string>& scenes, bool is_gpu_alone) {
  const std::vector<int> many = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512};
  std::vector<Run> runs = {{"jacobi", "cuda", many},
                           {"chebyshev", "cuda", many},
                           {"lbfgs", "cuda", {1, 2, 4, 8, 16, 32, 64}}};
  if (!is_gpu_alone) runs.insert(runs.end(), {{"jacobi", "cpu", many}, {"chebyshev", "cpu", many}});
  fmt::print("device,{}\nbody,solver,backend,iterations,error,milliseconds\n", gpu_name());
  for (const std::string& path : scenes) {
    const LoadedScene scene = load_scene(path);
    World& world = *scene.world;
    while (world.time() < 0.2) {
      if (!world.step()) throw InputError(world.failure());
    }
    ProjectiveSystem* system = world.bodies().front().model->system().as_projective();
    if (system == nullptr) throw InputError(path + ": its body has no projective system");
    // Gravity and whatever else acts on it are those of its last step.
    const std::string name = std::filesystem::path(path).stem().string();
    compare(*system, world.time_step(), name, runs);
    print_local_share(*system, name);
  }
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  CLI::App app("Times iterations of the CUDA backend");
  app.require_subcommand(1);
  std::vector<int> cells = {22, 103}, lengths, sides = {1000}, blocks = {128}, threads_each = {2};
  std::vector<std::string> solvers = {"chebyshev"};
  CLI::App* times = app.add_subcommand("iterations", "microseconds an iteration, and bandwidth");
  times->add_option("--cells", cells, "cubes of so many cells along an edge");
  times->add_option("--bars", lengths, "bars of 6 x 6 x so many cells");
  times->add_option("--sides", sides, "cloths of so many particles along an edge");
  times->add_option("--blocks", blocks, "particles in a block");
  times->add_option("--solvers", solvers, "whose iterations")
      ->check(CLI::IsMember({"chebyshev", "line_search_jacobi", "gauss_seidel", "hybrid", "lbfgs",
                             "lbfgs_chebyshev"}));
  times->add_option("--threads-per-particle", threads_each, "that share a block's simplices");
  int passes = 1;
  times->add_option("--passes", passes, "over a block's simplices")->check(CLI::Range(1, 2));
  int body = 22, threads = 1;
  CLI::App* errors = app.add_subcommand("accuracy", "error and time at three stiffnesses");
  errors->add_option("--cells", body, "cells along an edge of the cube");
  errors->add_option("--threads", threads, "of the CPU");
  std::vector<std::string> scenes;
  CLI::App* paper = app.add_subcommand("figures", "the patches' paper's, of the bodies of scenes");
  paper->add_option("scenes", scenes, "files")->required();
  bool is_gpu_alone = false;
  paper->add_flag("--gpu-alone", is_gpu_alone, "leave the CPU's iterations out");
  std::vector<int> folded = {50, 100, 316, 1000};
  int searchers = 1, steps = 20;
  CLI::App* searches =
      app.add_subcommand("contacts", "milliseconds of the search for what touches, CPU and GPU");
  searches->add_option("--sides", folded, "cloths of so many vertices along an edge");
  searches->add_option("--threads", searchers, "of the CPU");
  searches->add_option("--steps", steps, "that are timed")->check(CLI::Range(1, 10000));
  searches->add_flag("--gpu-alone", is_gpu_alone, "leave the CPU's search out");
  CLI11_PARSE(app, argc, argv);
  const std::string reason = pliant::why_no_gpu();
  if (!reason.empty()) {
    std::fprintf(stderr, "cuda_bench: no usable GPU: %s\n", reason.c_str());
    return 1;
  }
  try {
    if (times->parsed())
      pliant::bench::iterations(cells, lengths, sides, blocks, threads_each, solvers, passes);
    if (errors->parsed()) pliant::bench::accuracy(body, threads);
    if (paper->parsed()) pliant::bench::figures(scenes, is_gpu_alone);
    if (searches->parsed()) pliant::bench::search(folded, searchers, steps, !is_gpu_alone);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cuda_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
