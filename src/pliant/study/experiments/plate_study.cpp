#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/particle_scene.h"
#include "pliant/study/experiments/viscoelastic_study.h"

namespace pliant {
namespace {

constexpr double kPlateSpacing = 0.01;    // [m]
constexpr double kPlateFrame = 1.0 / 30;  // [s]
const Eigen::Vector3i kPlate(32, 26, 1);  // the paper's 832 particles

/// The paper's iterations without and with orientations, which took it the same time.
int paper_iterations(bool oriented) { return oriented ? 10 : 20; }

struct PlateRun {
  std::string solver;
  ParameterText parameters;
  bool oriented;
};

struct PlateEnd {
  Positions x;
  double drop, milliseconds;  // over the free length, the shortest step's
  int iterations;             // of the last step
};

double drop_of(const Positions& x, const Positions& rest) {
  const double edge = rest.row(0).maxCoeff() - 1e-6;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < x.cols(); ++i) {
    if (rest(0, i) < edge) continue;
    sum += rest(2, i) - x(2, i);
    ++count;
  }
  return sum / count / (kPlateSpacing * (kPlate[0] - 3));
}

PlateEnd hang(const PlateRun& run, double share) {
  ViscoelasticModel::Material material;
  material.solid.young = 2e6;
  material.solid.cluster_fraction = 1.0;
  material.oriented = run.oriented;
  ParticleScene scene(lattice_body(kPlate, kPlateSpacing), material, kPlateFrame);
  scene.fix_below(0, 3.0 * kPlateSpacing);
  scene.add_effect("gravity", {{"acceleration", "[0, 0, -0.5]"}});
  scene.add_effect("damping", {{"rate", "3"}});
  scene.start(run.solver, run.parameters);
  const Positions rest = scene.particles().x;
  PlateEnd end{rest, 0.0, 1e9, 0};
  for (int k = 0; k < std::max(1, static_cast<int>(std::lround(90 * share))); ++k) {
    if (!scene.world().step()) break;
    end.milliseconds = std::min(end.milliseconds, 1e3 * scene.body().report.seconds);
    end.iterations = scene.body().report.iterations;
  }
  end.x = scene.particles().x;
  end.drop = drop_of(end.x, rest);
  return end;
}

}  // namespace

bool study_viscoelastic_thin(const ExperimentOptions& options, const ExperimentProgress& progress) {
  std::string table = "solver,method,iterations,step_ms,drop_over_length\n";
  std::string plates = "solver,method,iterations,x_m,y_m,z_m\n";
  double done = 0.0;
  for (const std::string solver : {"shape_matching", "gauss_seidel"}) {
    for (const bool oriented : {false, true}) {
      const std::string method = oriented ? "oriented_particles" : "shape_matching";
      for (const int iterations : {paper_iterations(oriented), 400}) {
        if (!progress(done / 8.0, solver + ", " + method)) return false;
        done += 1.0;
        ParameterText parameters = {{"iterations", std::to_string(iterations)}};
        if (solver == "shape_matching") parameters["sweep"] = "gauss_seidel";
        const PlateEnd end = hang({solver, parameters, oriented}, options.share);
        table += fmt::format("{},{},{},{:.3f},{:.4f}\n", solver, method, iterations,
                             end.milliseconds, end.drop);
        for (int i = 0; i < end.x.cols(); ++i) {
          plates += fmt::format("{},{},{},{:.5g},{:.5g},{:.5g}\n", solver, method, iterations,
                                end.x(0, i), end.x(1, i), end.x(2, i));
        }
      }
    }
  }
  write_file_atomically(options.folder + "/thin.csv", table);
  write_file_atomically(options.folder + "/plates.csv", plates);
  return true;
}

}  // namespace pliant
