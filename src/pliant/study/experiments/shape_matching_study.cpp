#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/particle_scene.h"
#include "pliant/study/experiments/viscoelastic_study.h"

namespace pliant {
namespace {

constexpr double kLatticeSpacing = 0.01;  // [m]
constexpr int kPaperSteps = 140;          // the paper's

/// When the iterations of a step end.
struct SweepLimit {
  int iterations;
  double tolerance;  // of the clusters' mean strain; 0: as many iterations as said
};
constexpr int kMostSweeps = 3000;

/// What is deformed, how, and for how long steps iterate.
struct PaperLoad {
  std::string body;
  Eigen::Vector3i counts;
  bool held;
  std::vector<SweepLimit> limits;
};

std::vector<PaperLoad> paper_loads(double share) {
  const double cube = std::cbrt(share);
  const auto scaled = [&](int count) {
    return std::max(3, static_cast<int>(std::lround(cube * count)));
  };
  // 17 x 17 x 17 are the 4,913 particles of the paper.
  return {{"cube",
           Eigen::Vector3i::Constant(scaled(17)),
           true,
           {{kMostSweeps, 8e-3}, {kMostSweeps, 4e-3}, {5, 0.0}, {20, 0.0}}},
          {"bar", {scaled(30), 5, 5}, true, {{kMostSweeps, 3e-3}, {kMostSweeps, 2e-3}}},
          {"free bar", {scaled(30), 5, 5}, false, {{kMostSweeps, 3e-3}, {kMostSweeps, 1e-3}}}};
}

const std::vector<std::string> kPaperSweeps = {"jacobi", "weighted_jacobi", "gauss_seidel",
                                               "hybrid"};

/// How far the particles of the lowest layer, or of the far end, are below where they began, on
/// average [m].
double sunk(const Particles& p, const Positions& start, int axis) {
  const double edge = start.row(axis).maxCoeff() - 1e-6;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < p.size(); ++i) {
    if (start(axis, i) < edge) continue;
    sum += start(2, i) - p.x(2, i);
    ++count;
  }
  return sum / count;
}

void bend_and_turn(Particles& p) {
  const double half = 0.5 * (p.x.row(0).maxCoeff() + p.x.row(0).minCoeff());
  for (int i = 0; i < p.size(); ++i) {
    const double along = p.x(0, i) / half - 1.0;
    p.v.col(i) = Eigen::Vector3d(0.0, 0.5 * along, 1.5 * along * along - 0.5);
  }
}

std::string strain_rows(const PaperLoad& load, SweepLimit limit, const std::string& sweep,
                        int steps) {
  ViscoelasticModel::Material material;
  material.solid.cluster_fraction = 1.0;
  ParticleScene scene(lattice_body(load.counts, kLatticeSpacing), material, 0.01);
  if (load.held) scene.fix_below(0, 2.0 * kLatticeSpacing);
  if (load.held) scene.add_effect("gravity");
  scene.start("shape_matching", {{"sweep", sweep},
                                 {"iterations", std::to_string(limit.iterations)},
                                 {"tolerance", fmt::format("{}", limit.tolerance)}});
  const Positions start = scene.particles().x;
  if (!load.held) bend_and_turn(scene.particles());
  const Eigen::Vector3d before = scene.particles().angular_momentum();
  std::string rows;
  for (int step = 1; step <= steps; ++step) {
    if (!scene.world().step()) break;
    const StepReport& report = scene.body().report;
    const double lost = (scene.particles().angular_momentum() - before).norm() / before.norm();
    rows += fmt::format("{},\"{}\",{},{},{},{},{:.3g},{:.6g},{},{:.3f}\n", step, load.body,
                        load.counts.prod(), sweep, limit.tolerance, report.iterations,
                        report.residual, sunk(scene.particles(), start, 0),
                        load.held ? "" : fmt::format("{:.3g}", lost), 1e3 * report.seconds);
  }
  return rows;
}

}  // namespace

bool study_viscoelastic_shape_matching(const ExperimentOptions& options,
                                       const ExperimentProgress& progress) {
  std::string table =
      "step,body,particles,sweep,tolerance,iterations,strain,drop,angular_momentum_lost,step_ms\n";
  const std::vector<PaperLoad> all = paper_loads(options.share);
  const int steps = std::max(1, static_cast<int>(std::lround(kPaperSteps * options.share)));
  double done = 0.0;
  for (const PaperLoad& load : all) {
    for (const SweepLimit limit : load.limits) {
      for (const std::string& sweep : kPaperSweeps) {
        const double runs = static_cast<double>((2 * all.size() + 2) * kPaperSweeps.size());
        if (!progress(done / runs, load.body + ", " + sweep)) return false;
        done += 1.0;
        table += strain_rows(load, limit, sweep, steps);
      }
    }
  }
  write_file_atomically(options.folder + "/shape_matching.csv", table);
  return true;
}

}  // namespace pliant
