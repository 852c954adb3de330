// One step of direct (one iteration: a local step and a global one) beside Eigen's own sparse
// Cholesky solve of the same matrix alone.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>

#include "convergence_scenes.h"
#include "pliant/solvers/linear/cholesky.h"
#include "pliant/solvers/registry.h"

namespace pliant::bench {
namespace {

struct Prepared {
  std::unique_ptr<World> world;
  SparseRows matrix;
};

Prepared prepare(std::size_t scene) {
  Prepared prepared{convergence_scenes()[scene].make(), {}};
  Body& body = prepared.world->bodies().front();
  prepared.world->set_solver(body, solver_registry(), "direct", {{"iterations", "10"}}, "bench");
  prepared.matrix = projective_matrix(static_cast<const ProjectiveSystem&>(body.model->system()),
                                      prepared.world->time_step());
  return prepared;
}

void direct_step(benchmark::State& state, std::size_t scene) {
  Prepared prepared = prepare(scene);
  double global = 0.0, all = 0.0;
  for (auto _ : state) {
    prepared.world->step();
    const StepReport& report = prepared.world->bodies().front().report;
    for (const PhaseTime& phase : report.phases) {
      if (phase.name == "global") global += phase.seconds;
    }
    all += report.seconds;
  }
  state.counters["local_share"] = 1.0 - global / all;
  state.counters["per_iteration_ms"] = 100.0 * all / static_cast<double>(state.iterations());
}

void our_solve(benchmark::State& state, std::size_t scene) {
  const Prepared prepared = prepare(scene);
  CholeskySolver solver;
  solver.factor(prepared.matrix);
  Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Random(3, prepared.matrix.rows());
  for (auto _ : state) {
    solver.solve(b);
    benchmark::ClobberMemory();
  }
}

void eigen_solve(benchmark::State& state, std::size_t scene) {
  const Prepared prepared = prepare(scene);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(
      Eigen::SparseMatrix<double>(prepared.matrix));
  const Eigen::MatrixX3d b = Eigen::MatrixX3d::Random(prepared.matrix.rows(), 3);
  Eigen::MatrixX3d x = b;
  for (auto _ : state) {
    x = ldlt.solve(b);
    benchmark::ClobberMemory();
  }
}

void register_scenes() {
  const auto scenes = convergence_scenes();
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const std::string& name = scenes[s].name;
    benchmark::RegisterBenchmark(("step/" + name).c_str(), direct_step, s);
    benchmark::RegisterBenchmark(("our_solve/" + name).c_str(), our_solve, s);
    benchmark::RegisterBenchmark(("eigen_ldlt_solve/" + name).c_str(), eigen_solve, s);
  }
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::register_scenes();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
