#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/core/step/timer.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/models/viscoelastic/cluster_plan.h"
#include "pliant/study/experiments/carried_mesh.h"
#include "pliant/study/experiments/figure_scene.h"
#include "pliant/study/experiments/viscoelastic_study.h"

namespace pliant {
namespace {

constexpr double kDrawnParticles = 6525.0;                           // the paper's
const std::vector<double> kDrawnClusters = {6525.0, 2106.0, 889.0};  // likewise

/// Where particles are and how they have turned.
struct Turned {
  Eigen::Matrix3Xd x;
  Eigen::Matrix4Xd turns;
};

Turned bent(const BodyGeometry& figure, double fraction, int steps, int iterations) {
  ViscoelasticModel::Material material;
  material.solid.young = 2.5e3;
  material.solid.cluster_fraction = fraction;
  material.oriented = true;
  material.turn_blend = TurnBlend::kLinear;
  ParticleScene scene(figure, material, 0.033);
  bend_figure(scene, figure_spacing(figure));
  scene.start("chebyshev", {{"iterations", std::to_string(iterations)}, {"tolerance", "1e-3"}});
  for (int k = 0; k < steps && scene.world().step(); ++k) continue;
  Turned result{scene.particles().x, Eigen::Matrix4Xd(4, scene.particles().size())};
  const OrientedClusterSet& set = *scene.model().system().solid().oriented();
  for (int i = 0; i < scene.particles().size(); ++i) {
    result.turns.col(i) = set.orientation(i).coeffs();
  }
  return result;
}

struct Drawing {
  std::string name;
  CarriedMesh::Blend blend;
};

const std::vector<Drawing> kDrawings = {{"nearest", CarriedMesh::Blend::kNearest},
                                        {"qlerp", CarriedMesh::Blend::kLinear},
                                        {"exponential", CarriedMesh::Blend::kExponential}};

std::vector<int> all_of(const BodyGeometry& figure) {
  std::vector<int> all(static_cast<std::size_t>(figure.interior_points.cols()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// One row for each way to draw the figure that `carriers` carry, and its mesh.
std::string drawn_rows(const ExperimentOptions& options, const TriangleMesh& mesh,
                       const BodyGeometry& figure, const Turned& state,
                       const std::vector<int>& carriers, double clusters) {
  const CarriedMesh whole(mesh, figure.interior_points);
  const Eigen::Matrix3Xd truth = whole.carry(state.x, state.turns, CarriedMesh::Blend::kLinear);
  const CarriedMesh carried(mesh, figure.interior_points(Eigen::all, carriers));
  const Eigen::Matrix3Xd x = state.x(Eigen::all, carriers);
  const Eigen::Matrix4Xd turns = state.turns(Eigen::all, carriers);
  std::string rows;
  for (const Drawing& drawing : kDrawings) {
    TriangleMesh drawn = mesh;
    double seconds = 1e9;
    for (int k = 0; k < 5; ++k) {
      const Timer timer;
      drawn.vertices = carried.carry(x, turns, drawing.blend);
      seconds = std::min(seconds, timer.seconds());
    }
    const Eigen::VectorXd apart = (drawn.vertices - truth).colwise().norm();
    rows += fmt::format("{},{},{:.4g},{:.4g},{:.4g},{:.3g}\n", carriers.size(), drawing.name,
                        1e3 * apart.mean(), 1e3 * apart.maxCoeff(),
                        rms_angle_change(mesh, drawn.vertices),
                        1e9 * seconds / static_cast<double>(apart.size()));
    write_obj(fmt::format("{}/rendering_{:.0f}_{}.obj", options.folder, clusters, drawing.name),
              drawn);
  }
  return rows;
}

}  // namespace

bool study_viscoelastic_rendering(const ExperimentOptions& options,
                                  const ExperimentProgress& progress) {
  const TriangleMesh mesh = read_triangle_mesh(options.figure);
  // Fewer could not carry it.
  const double particles = std::max(200.0, kDrawnParticles * options.share);
  const BodyGeometry figure = filled_figure(options.figure, particles);
  const int steps = std::max(2, static_cast<int>(std::lround(10 * options.share)));
  const int iterations = std::max(5, static_cast<int>(std::lround(60 * options.share)));
  std::string table =
      "carriers,blend,mean_apart_mm,largest_apart_mm,rms_angle_change_deg,ns_per_vertex\n";
  double done = 0.0;
  for (const double clusters : kDrawnClusters) {
    if (!progress(done / 3.0, fmt::format("{} clusters", clusters))) return false;
    done += 1.0;
    const double fraction = clusters / kDrawnParticles;
    const Turned state = bent(figure, fraction, steps, iterations);
    const double separation = separation_for(figure.interior_points, all_of(figure), fraction,
                                             2.1 * figure_spacing(figure));
    const std::vector<int> carriers =
        clusters == kDrawnParticles
            ? all_of(figure)
            : spaced_subset(figure.interior_points, all_of(figure), separation);
    table += drawn_rows(options, mesh, figure, state, carriers, clusters);
  }
  write_file_atomically(options.folder + "/rendering.csv", table);
  return true;
}

}  // namespace pliant
