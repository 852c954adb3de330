#include "pliant/study/experiments/viscoelastic_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/step/timer.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/rotation_mean.h"
#include "pliant/study/experiments/particle_scene.h"

namespace pliant {
namespace {

constexpr double kFrame = 0.033;  // [s]

int scaled(double count, double share) {
  return std::max(1, static_cast<int>(std::lround(count * share)));
}

double cube_share(double share) { return std::cbrt(share); }

/// A lattice whose points are a little out of place, so that centres may have any distance.
BodyGeometry uneven_lattice(const Eigen::Vector3i& counts, double spacing) {
  BodyGeometry body = lattice_body(counts, spacing);
  unsigned state = 1;
  for (Eigen::Index k = 0; k < body.interior_points.size(); ++k) {
    state = 1664525u * state + 1013904223u;
    body.interior_points.data()[k] +=
        0.2 * spacing * (static_cast<double>(state) / 4294967296.0 - 0.5);
  }
  return body;
}

/// How far the particles within `reach` of the largest x have sunk, on average [m].
double tip_drop(const Particles& p, const Positions& rest, double reach = 1e-6) {
  const double edge = rest.row(0).maxCoeff() - reach;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < p.size(); ++i) {
    if (rest(0, i) < edge) continue;
    sum += rest(2, i) - p.x(2, i);
    ++count;
  }
  return sum / count;
}

}  // namespace

const std::vector<Experiment>& viscoelastic_experiments() {
  static const std::vector<Experiment> all = {
      {"solvers", "iterations to the same residual over 140 steps of a loaded bar",
       study_viscoelastic_solvers},
      {"shape_matching",
       "the paper's iterations to the same strain over 140 steps of loaded bodies",
       study_viscoelastic_shape_matching},
      {"clusters", "6525 particles with all, 2106 and 889 clusters in 33 ms",
       study_viscoelastic_clusters},
      {"figure", "a rabbit with as many clusters, by QLERP and the exponential map in the solve",
       study_viscoelastic_figure},
      {"states", "the rabbit dropped, rigid, elastic, viscoelastic and liquid",
       study_viscoelastic_states},
      {"rendering", "the rabbit's mesh carried by all and by sampled clusters, with means of turns",
       study_viscoelastic_rendering},
      {"thin", "a plate of 832 particles: shape matching and oriented particles",
       study_viscoelastic_thin},
      {"interpolation", "means of rotations: QLERP and exponential map",
       study_viscoelastic_interpolation},
      {"speed", "steps a second of each state, and each phase's share", study_viscoelastic_speed},
  };
  return all;
}

namespace {

const std::vector<std::string> kStudiedSolvers = {"jacobi", "line_search_jacobi", "gauss_seidel",
                                                  "hybrid", "chebyshev",          "direct"};

// What happens to the bar: it is held at an end under its weight, or bends and turns freely; with
// as many iterations as the residual takes, or with a few.
const std::vector<std::string> kBars = {"held", "free", "free, 5 iterations"};

std::string solver_rows(const std::string& solver, const std::string& bar, double share) {
  const bool is_held = bar == "held";
  const double spacing = 0.01;
  const Eigen::Vector3i counts(scaled(30, cube_share(share)), 5, 5);
  ViscoelasticModel::Material material;
  material.solid.young = 5e4;
  ParticleScene scene(lattice_body(counts, spacing), material, 0.01);
  if (is_held) scene.fix_below(0, 2.0 * spacing);
  if (is_held) scene.add_effect("gravity");
  ParameterText parameters = {{"iterations", "1000"}, {"tolerance", "1e-3"}};
  if (bar == kBars.back()) parameters = {{"iterations", "5"}};
  scene.start(solver, parameters);
  const Positions rest = scene.particles().x;
  const double half = 0.5 * spacing * counts[0];
  for (int i = 0; !is_held && i < scene.particles().size(); ++i) {
    const double along = rest(0, i) / half - 1.0;
    scene.particles().v.col(i) = Eigen::Vector3d(0.0, 0.5 * along, 1.5 * along * along - 0.5);
  }
  const Eigen::Vector3d before = scene.particles().angular_momentum();
  std::string rows;
  for (int step = 1; step <= scaled(140, share); ++step) {
    if (!scene.world().step()) break;
    const StepReport& report = scene.body().report;
    const double turned = (scene.particles().angular_momentum() - before).norm() / before.norm();
    rows += fmt::format("{},\"{}\",\"{}\",{},{:.3g},{:.6g},{}\n", step, bar, solver,
                        report.iterations, report.residual, tip_drop(scene.particles(), rest),
                        is_held ? "" : fmt::format("{:.3g}", turned));
  }
  return rows;
}

}  // namespace

bool study_viscoelastic_solvers(const ExperimentOptions& options,
                                const ExperimentProgress& progress) {
  std::string table = "step,bar,solver,iterations,residual,drop,angular_momentum_lost\n";
  double done = 0.0;
  for (const std::string& bar : kBars) {
    for (const std::string& solver : kStudiedSolvers) {
      const double all = static_cast<double>(kBars.size() * kStudiedSolvers.size());
      if (!progress(done / all, solver)) return false;
      done += 1.0;
      table += solver_rows(solver, bar, options.share);
    }
  }
  write_file_atomically(options.folder + "/solvers.csv", table);
  return true;
}

bool study_viscoelastic_clusters(const ExperimentOptions& options,
                                 const ExperimentProgress& progress) {
  const double spacing = 0.01, share = cube_share(options.share);
  // 29 x 15 x 15 = 6525.
  const Eigen::Vector3i counts(scaled(29, share), scaled(15, share), scaled(15, share));
  const double particles = counts.prod();
  std::string table =
      "particles,clusters,solver,iteration_ms,iterations_in_33_ms,drop_in_33_ms,drop_converged,"
      "prepare_s\n";
  double done = 0.0;
  for (const double clusters : {6525.0, 2106.0, 889.0}) {
    // What shall be seen: with many iterations, and with those that 33 ms hold.
    double converged = 0.0;
    for (const std::string solver : {"chebyshev", "jacobi"}) {
      if (!progress(done / 6.0, fmt::format("{} clusters, {}", clusters, solver))) return false;
      done += 1.0;
      ViscoelasticModel::Material material;
      material.solid.young = 4e4;
      material.solid.cluster_fraction = std::min(1.0, clusters / 6525.0);
      const auto run = [&](int iterations, double tolerance, double& prepare, double& step) {
        ParticleScene scene(uneven_lattice(counts, spacing), material, kFrame);
        scene.fix_below(0, 2.0 * spacing);
        scene.add_effect("gravity");
        scene.add_effect("damping", {{"rate", "10"}});
        const Timer timer;
        scene.start(solver, {{"iterations", std::to_string(iterations)},
                             {"tolerance", fmt::format("{}", tolerance)}});
        prepare = timer.seconds();
        const Positions rest = scene.particles().x;
        step = 1.0;
        for (int k = 0; k < scaled(8, options.share); ++k) {
          if (!scene.world().step()) break;
          if (k > 0) step = std::min(step, scene.body().report.seconds);
        }
        return std::pair(tip_drop(scene.particles(), rest, 0.6 * spacing),
                         scene.model().system().solid().size());
      };
      double prepare = 0.0, few = 0.0, many = 0.0, none = 0.0;
      const int probe = 20;
      run(2, 0.0, none, few);
      run(2 + probe, 0.0, prepare, many);
      const double iteration = std::max(1e-7, (many - few) / probe);
      const int fit = std::max(1, static_cast<int>((kFrame - (few - 2.0 * iteration)) / iteration));
      double unused = 0.0;
      const auto [drop, count] = run(fit, 0.0, none, unused);
      if (solver == "chebyshev") converged = run(300, 1e-2, none, unused).first;
      table += fmt::format("{},{},{},{:.3f},{},{:.5g},{:.5g},{:.3g}\n", particles, count, solver,
                           1e3 * iteration, fit, drop, converged, prepare);
    }
  }
  write_file_atomically(options.folder + "/clusters.csv", table);
  return true;
}

bool study_viscoelastic_interpolation(const ExperimentOptions& options,
                                      const ExperimentProgress& progress) {
  std::string table =
      "neighbours_differ_by_deg,mean_difference_deg,largest_difference_deg,"
      "qlerp_ns,exponential_ns\n";
  // Six sampled clusters about a particle, whose rotations differ as those of a bent bar do.
  for (const double degrees : {1.0, 5.0, 15.0, 45.0, 90.0}) {
    if (!progress(degrees / 90.0, fmt::format("{} degrees", degrees))) return false;
    const int trials = scaled(20000, options.share);
    unsigned state = 1;
    const auto random = [&] {
      state = 1664525u * state + 1013904223u;
      return static_cast<double>(state) / 4294967296.0 - 0.5;
    };
    std::vector<Eigen::Matrix4Xd> all;
    std::vector<Eigen::VectorXd> weights;
    for (int t = 0; t < trials; ++t) {
      Eigen::Matrix4Xd rotations(4, 6);
      Eigen::VectorXd weight(6);
      for (int k = 0; k < 6; ++k) {
        const Eigen::Vector3d axis = Eigen::Vector3d(random(), random(), random()).normalized();
        const double angle = degrees * M_PI / 180.0 * random();
        rotations.col(k) = Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)).coeffs();
        weight[k] = 0.6 + random();
      }
      all.push_back(rotations);
      weights.push_back(weight);
    }
    std::vector<Eigen::Quaterniond> linear, exponential;
    const Timer first;
    for (int t = 0; t < trials; ++t) {
      linear.push_back(linear_rotation_mean(all[static_cast<std::size_t>(t)],
                                            weights[static_cast<std::size_t>(t)]));
    }
    const double qlerp = first.seconds();
    const Timer second;
    for (int t = 0; t < trials; ++t) {
      exponential.push_back(exponential_rotation_mean(all[static_cast<std::size_t>(t)],
                                                      weights[static_cast<std::size_t>(t)]));
    }
    const double mapped = second.seconds();
    double sum = 0.0, largest = 0.0;
    for (std::size_t t = 0; t < linear.size(); ++t) {
      const double apart = linear[t].angularDistance(exponential[t]) * 180.0 / M_PI;
      sum += apart;
      largest = std::max(largest, apart);
    }
    table += fmt::format("{},{:.3g},{:.3g},{:.4g},{:.4g}\n", degrees, sum / trials, largest,
                         1e9 * qlerp / trials, 1e9 * mapped / trials);
  }
  write_file_atomically(options.folder + "/interpolation.csv", table);
  return true;
}

ViscoelasticModel::Material material_of_state(const std::string& state) {
  ViscoelasticModel::Material material;
  material.beta = state == "liquid" ? 1.0 : state == "viscoelastic" ? 0.5 : 0.0;
  material.solid.young = 4e4;
  material.solid.cluster_fraction = 0.15;
  material.solid.rigid = state == "rigid";
  if (material.solid.rigid) material.solid.alpha = 0.99;
  return material;
}

namespace {

/// What the surface takes, after steps that moved everything [ms]: the least of some times.
double surface_milliseconds(ParticleScene& scene) {
  double least = 1e9;
  for (int k = 0; k < 3 && scene.world().step(); ++k) {
    const Timer timer;
    scene.model().surface_vertices();
    least = std::min(least, 1e3 * timer.seconds());
  }
  return least;
}

/// A row of the table: substeps, one millisecond long, of a block in one state.
std::string speed_row(const Eigen::Vector3i& counts, const std::string& state) {
  // Substeps count one by one, so that the figures are those of one.
  ParticleScene scene(lattice_body(counts, 0.01), material_of_state(state), 0.001);
  scene.add_effect("gravity");
  const Timer prepare;
  scene.start("jacobi", {{"iterations", "5"}, {"tolerance", "1e-3"}});
  const int steps = counts.prod() > 100000 ? 5 : 20;
  double seconds = 0.0, substeps = 0.0, first = 0.0;
  StepReport sum;
  for (int k = 0; k <= steps; ++k) {
    if (!scene.world().step()) break;
    if (k == 0) first = prepare.seconds();
    if (k == 0) continue;
    const StepReport& report = scene.body().report;
    seconds += report.seconds;
    substeps += scene.body().substeps;
    for (const PhaseTime& phase : report.phases) sum.add_time(phase.name, phase.seconds);
  }
  std::string phases;
  for (const PhaseTime& phase : sum.phases) {
    phases += fmt::format("{}{} {:.0f} %", phases.empty() ? "" : "; ", phase.name,
                          100.0 * phase.seconds / seconds);
  }
  return fmt::format("{},{},{},{:.4g},{:.4g},{:.1f},{:.3g},\"{}\"\n", counts.prod(), state,
                     substeps / steps, steps / seconds, counts.prod() * substeps / seconds,
                     surface_milliseconds(scene), first, phases);
}

}  // namespace

bool study_viscoelastic_speed(const ExperimentOptions& options,
                              const ExperimentProgress& progress) {
  std::string table =
      "particles,state,parts,steps_per_second,particle_parts_per_second,surface_ms,prepare_s,"
      "phases\n";
  const double share = cube_share(options.share);
  double done = 0.0;
  for (const Eigen::Vector3i& full :
       std::vector<Eigen::Vector3i>{{29, 15, 15}, {50, 40, 25}, {80, 50, 50}}) {
    const Eigen::Vector3i counts(scaled(full[0], share), scaled(full[1], share),
                                 scaled(full[2], share));
    for (const char* state : {"rigid", "elastic", "viscoelastic", "liquid"}) {
      if (!progress(done / 12.0, fmt::format("{} particles, {}", counts.prod(), state))) {
        return false;
      }
      done += 1.0;
      table += speed_row(counts, state);
    }
  }
  write_file_atomically(options.folder + "/speed.csv", table);
  return true;
}

}  // namespace pliant
