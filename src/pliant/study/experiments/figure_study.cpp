#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/step/timer.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/models/viscoelastic/cluster_plan.h"
#include "pliant/study/experiments/figure_scene.h"
#include "pliant/study/experiments/viscoelastic_study.h"

namespace pliant {
namespace {

constexpr double kFigureFrame = 0.033;                                // [s]
constexpr double kFigureParticles = 6525.0;                           // the paper's
const std::vector<double> kFigureClusters = {6525.0, 2106.0, 889.0};  // likewise

/// How far the upper third has moved, on average [m].
double sway(const Particles& p, const Positions& start) {
  const double low = start.row(2).minCoeff(), high = start.row(2).maxCoeff();
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < p.size(); ++i) {
    if (start(2, i) < low + (high - low) * 2.0 / 3.0) continue;
    sum += (p.x.col(i) - start.col(i)).norm();
    ++count;
  }
  return sum / std::max(1, count);
}

struct Bent {
  Positions x;        // at the end
  double sway, step;  // [m], the shortest [s]
  int clusters;
};

Bent bent_figure(const BodyGeometry& figure, const ViscoelasticModel::Material& material,
                 const std::string& solver, int iterations, double tolerance, int steps) {
  ParticleScene scene(figure, material, kFigureFrame);
  bend_figure(scene, figure_spacing(figure));
  scene.start(solver, {{"iterations", std::to_string(iterations)},
                       {"tolerance", fmt::format("{}", tolerance)}});
  const Positions start = scene.particles().x;
  double step = 1e9;
  for (int k = 0; k < steps && scene.world().step(); ++k) {
    if (k > 0) step = std::min(step, scene.body().report.seconds);
  }
  return {scene.particles().x, sway(scene.particles(), start), step,
          scene.model().system().solid().size()};
}

struct Turns {
  std::string name;
  bool oriented;
  TurnBlend blend;
};

const std::vector<Turns> kTurns = {{"none", false, TurnBlend::kMoments},
                                   {"qlerp", true, TurnBlend::kLinear},
                                   {"exponential", true, TurnBlend::kExponential}};

/// Which particles are centres, of each number of clusters.
std::string centre_rows(const BodyGeometry& figure, double share) {
  const Positions& x = figure.interior_points;
  std::vector<int> all(static_cast<std::size_t>(x.cols()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  std::string rows = "clusters,x_m,y_m,z_m\n";
  for (const double clusters : kFigureClusters) {
    const double separation = separation_for(x, all, std::min(1.0, clusters / kFigureParticles),
                                             2.1 * figure_spacing(figure));
    for (const int i : spaced_subset(x, all, separation)) {
      rows += fmt::format("{},{:.5g},{:.5g},{:.5g}\n", std::lround(clusters * share), x(0, i),
                          x(1, i), x(2, i));
    }
  }
  return rows;
}

}  // namespace

bool study_viscoelastic_figure(const ExperimentOptions& options,
                               const ExperimentProgress& progress) {
  const BodyGeometry figure = filled_figure(options.figure, kFigureParticles * options.share);
  const int steps = std::max(2, static_cast<int>(std::lround(8 * options.share)));
  write_file_atomically(options.folder + "/centres.csv", centre_rows(figure, options.share));
  std::string table =
      "particles,clusters,turns,iteration_ms,iterations_in_33_ms,sway_in_33_ms,sway_converged,"
      "apart_from_qlerp\n";
  double done = 0.0;
  for (const double clusters : kFigureClusters) {
    Positions by_qlerp;
    for (const Turns& turns : kTurns) {
      const double all = static_cast<double>(kFigureClusters.size() * kTurns.size());
      if (!progress(done / all, fmt::format("{} clusters, {}", clusters, turns.name))) return false;
      done += 1.0;
      ViscoelasticModel::Material material;
      material.solid.young = 4e3;
      material.solid.cluster_fraction = std::min(1.0, clusters / kFigureParticles);
      material.oriented = turns.oriented;
      material.turn_blend = turns.blend;
      const int probe = 10;
      const double few = bent_figure(figure, material, "jacobi", 2, 0.0, 4).step;
      const double many = bent_figure(figure, material, "jacobi", 2 + probe, 0.0, 4).step;
      const double iteration = std::max(1e-7, (many - few) / probe);
      const int fit =
          std::max(1, static_cast<int>((kFigureFrame - (few - 2.0 * iteration)) / iteration));
      const Bent in_time = bent_figure(figure, material, "jacobi", fit, 0.0, steps);
      const Bent converged = bent_figure(figure, material, "chebyshev", 300, 1e-3, steps);
      if (turns.name == "qlerp") by_qlerp = converged.x;
      const double apart =
          turns.name == "exponential" ? (converged.x - by_qlerp).colwise().norm().maxCoeff() : 0.0;
      table += fmt::format("{},{},{},{:.3f},{},{:.4g},{:.4g},{:.3g}\n",
                           figure.interior_points.cols(), converged.clusters, turns.name,
                           1e3 * iteration, fit, in_time.sway, converged.sway, apart);
    }
  }
  write_file_atomically(options.folder + "/figure.csv", table);
  return true;
}

bool study_viscoelastic_states(const ExperimentOptions& options,
                               const ExperimentProgress& progress) {
  const BodyGeometry figure = filled_figure(options.figure, 3000.0 * options.share);
  const double spacing = figure_spacing(figure);
  std::string table = "state,time_s,x_m,y_m,z_m\n";
  double done = 0.0;
  for (const std::string state : {"rigid", "elastic", "viscoelastic", "liquid"}) {
    if (!progress(done / 4.0, state)) return false;
    done += 1.0;
    // Soft enough to see what each state does; what is viscoelastic creeps, too.
    ViscoelasticModel::Material material = material_of_state(state);
    material.solid.young = 2e3;
    material.liquid.viscosity = 2.0;
    ParticleScene scene(figure, material, 0.005);
    Obstacle floor;
    floor.name = "floor";
    floor.shape = std::make_shared<Plane>();
    const double low = scene.particles().x.row(2).minCoeff();
    floor.pose_start = floor.pose_end =
        Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, low - 0.02));
    scene.world().add_obstacle(floor);
    scene.add_effect("gravity");
    scene.add_effect("contact", {{"thickness", fmt::format("{}", 0.4 * spacing)}});
    scene.add_effect("friction");
    if (state == "viscoelastic") scene.add_effect("plasticity", {{"yield", "0.02"}, {"rate", "5"}});
    scene.start("jacobi", {{"iterations", "20"}});
    const int steps = std::max(3, static_cast<int>(std::lround(90 * options.share)));
    for (int k = 0; k <= steps; ++k) {
      if (k % (steps / 3) == 0) {
        const Positions& x = scene.particles().x;
        for (int i = 0; i < scene.particles().size(); ++i) {
          table += fmt::format("{},{:.3f},{:.5g},{:.5g},{:.5g}\n", state, scene.world().time(),
                               x(0, i), x(1, i), x(2, i) - low + 0.02);
        }
      }
      if (!scene.world().step()) break;
    }
  }
  write_file_atomically(options.folder + "/states.csv", table);
  return true;
}

}  // namespace pliant
