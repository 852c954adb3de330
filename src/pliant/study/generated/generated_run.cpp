#include "pliant/study/generated/generated_run.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <limits>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// FNV-1a of the bytes.
void add_to_hash(const Eigen::Matrix3Xd& values, std::uint64_t& hash) {
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    std::uint64_t bits;
    std::memcpy(&bits, values.data() + k, sizeof bits);
    for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (bits >> (8 * byte) & 255)) * 0x100000001b3;
  }
}

Positions points_of(const Body& body) {
  const bool is_free = body.model->name() != "rigid" && body.model->name() != "reduced";
  return is_free ? body.particles().x : body.model->surface().vertices;
}

/// Where nothing of a body may be: points on it; where the surface is made anew, its particles.
Positions touching_points(const Body& body) {
  return body.model->surface_changes() ? body.particles().x : body.model->surface().vertices;
}

/// How deep the deepest point is within a convex body.
double depth_within(const TriangleMesh& solid, const Positions& points) {
  double deepest = 0.0;
  for (const auto p : points.colwise()) {
    double depth = std::numeric_limits<double>::infinity();
    for (const auto t : solid.triangles.colwise()) {
      const Eigen::Vector3d a = solid.vertices.col(t[0]);
      const Eigen::Vector3d normal = (solid.vertices.col(t[1]) - a)
                                         .cross(Eigen::Vector3d(solid.vertices.col(t[2]) - a))
                                         .normalized();
      depth = std::min(depth, -normal.dot(p - a));
    }
    deepest = std::max(deepest, depth);
  }
  return deepest;
}

double depth_of(const World& world) {
  const Positions points = touching_points(world.bodies().front());
  double deepest = 0.0;
  for (const Obstacle& obstacle : world.obstacles()) {
    const Eigen::Isometry3d shape_from_world = obstacle.pose_end.inverse();
    for (const auto p : points.colwise()) {
      deepest = std::max(deepest, -obstacle.shape->distance(shape_from_world * p));
    }
  }
  for (const Body& body : world.bodies()) {
    if (body.name == "other") {
      deepest = std::max(deepest, depth_within(body.model->surface(), points));
    }
  }
  return deepest;
}

Eigen::Vector3d momentum_of(const World& world) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Body& body : world.bodies()) sum += body.particles().momentum();
  return sum;
}

bool is_finite(const World& world) {
  return std::all_of(world.bodies().begin(), world.bodies().end(), [](const Body& body) {
    return body.particles().x.allFinite() && body.particles().v.allFinite();
  });
}

bool tells(const StepReport& report, const char* what) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const std::string& text) { return text.find(what) != std::string::npos; });
}

bool is_lost(const StepReport& report) {
  constexpr double kLost = 0.5;  // of the travel
  if (report.error.value_or(0.0) > kLost) return true;
  return tells(report, "held_back");
}

/// Looks at a world before its first step and after each.
class RunWatch {
 public:
  RunWatch(const World& world, const Eigen::Vector3d& gravity, GeneratedRun& run)
      : gravity_(gravity), run_(run), start_(points_of(world.bodies().front())) {
    for (const Body& body : world.bodies()) run_.mass += body.particles().mass.sum();
    const Energies energies = world.energies();
    run_.energy_start = energies.kinetic + energies.elastic;
    energy_ = energies.total();
    momentum_ = momentum_of(world);
    run_.depth = 0.0;
    run_.start = start_;
    const Particles& particles = world.bodies().front().particles();
    run_.weight = particles.mass;
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.is_fixed(i)) run_.weight[i] = 0.0;
    }
    depth_ = depth_of(world);
  }

  void look(const World& world) {
    double scale = 0.0;
    for (const Body& body : world.bodies()) {
      const Particles& p = body.particles();
      add_to_hash(p.x, run_.hash);
      add_to_hash(p.v, run_.hash);
      scale += p.mass.dot(p.v.colwise().norm().transpose());
      run_.is_lost = run_.is_lost || is_lost(body.report);
      run_.is_warned = run_.is_warned || body.substeps > 1 || !body.report.warnings.empty();
    }
    const StepReport& report = world.bodies().front().report;
    run_.error = report.error;
    run_.is_inaccurate = tells(report, "inaccurate");
    run_.is_unsure = run_.is_unsure || run_.is_inaccurate || tells(report, "not_converged") ||
                     tells(report, "held_back");
    ++run_.steps;
    const Energies now = world.energies();
    run_.energy_gained = std::max(run_.energy_gained, now.kinetic + now.potential - energy_);
    run_.momentum_scale = std::max(run_.momentum_scale, scale);
    const Eigen::Vector3d expected = momentum_ + world.time() * run_.mass * gravity_;
    run_.momentum_missing = std::max(run_.momentum_missing, (momentum_of(world) - expected).norm());
    run_.depth = std::max(run_.depth, depth_of(world) - depth_);
  }

  void end(const World& world) {
    const Body& body = world.bodies().front();
    run_.points = points_of(body);
    run_.reach = run_.points.colwise().norm().maxCoeff();
    if (run_.points.cols() == start_.cols()) {
      run_.travel = (run_.points - start_).colwise().norm().maxCoeff();
    }
    const Particles& p = body.particles();
    run_.state.assign(p.x.data(), p.x.data() + p.x.size());
    run_.state.insert(run_.state.end(), p.v.data(), p.v.data() + p.v.size());
  }

 private:
  Eigen::Vector3d gravity_;
  GeneratedRun& run_;
  Positions start_;
  double energy_ = 0.0, depth_ = 0.0;
  Eigen::Vector3d momentum_ = Eigen::Vector3d::Zero();
};

void run_world(int steps, World& world, const Eigen::Vector3d& gravity, GeneratedRun& run) {
  RunWatch watch(world, gravity, run);
  for (int k = 0; k < steps; ++k) {
    if (!world.step()) {
      run.refusal = world.failure();
      if (run.refusal.empty()) run.refusal = "?";  // what no refusal may be
      break;
    }
    watch.look(world);
  }
  run.is_finite = is_finite(world);
  watch.end(world);
}

}  // namespace

GeneratedRun run_generated(const SceneChoice& choice, const SceneTelling& telling, int threads,
                           const std::string& robot) {
  GeneratedRun run;
  const double start = cpu_seconds();
  set_threads(threads);
  try {
    const LoadedScene scene = make_generated(choice, telling, robot);
    run.is_built = true;
    const int steps = telling.steps > 0 ? telling.steps : facts_of(choice).steps;
    run_world(steps, *scene.world, gravity_of(choice, telling), run);
  } catch (const InputError& error) {
    run.refusal = error.what();
  }
  set_threads(1);
  run.seconds = cpu_seconds() - start;
  return run;
}

}  // namespace pliant
