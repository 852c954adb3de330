#include "pliant/study/experiments/reduced_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {
namespace {

/// Bounds of |q|∞ beyond which the body is a hundred times its size.
double largest_coordinate(const StudyBody& body) {
  return 100.0 * body.size / body.model.basis.cwiseAbs().maxCoeff();
}

bool is_bounded(const Eigen::VectorXd& q, double bound) {
  return q.cwiseAbs().maxCoeff() <= bound && q.allFinite();
}

double peak_displacement(const StudyBody& body, ReducedLoad load, double force) {
  ReducedRunOptions options;
  options.integrator = {"midpoint", "midpoint", {}};
  options.load = load;
  options.force = force;
  options.duration = 2.0;
  double peak = 0.0;
  run_reduced(body, options, [&](const ReducedSystem& system, double) {
    peak = std::max(peak, relative_displacement(body, system.q));
    return true;
  });
  return peak;
}

/// The force whose peak is `share`, to 1 %; the peak grows with the force.
double calibrate(const StudyBody& body, ReducedLoad load, double share) {
  double force = 1.0;
  for (int trial = 0; trial < 60; ++trial) {
    const double ratio = share / peak_displacement(body, load, force);
    if (std::abs(ratio - 1.0) < 0.01) break;
    force *= std::clamp(ratio, 0.1, 1e6);
  }
  return force;
}

}  // namespace

double working_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::string to_string(ReducedLoad load) {
  switch (load) {
    case ReducedLoad::kImpulse:
      return "impulse";
    case ReducedLoad::kConstant:
      return "constant";
    case ReducedLoad::kSine:
      break;
  }
  return "sine";
}

double load_at(ReducedLoad load, double time) {
  switch (load) {
    case ReducedLoad::kImpulse:
      return time < 0.003 ? 1.0 : 0.0;
    case ReducedLoad::kConstant:
      return time < 0.3 ? 1.0 : 0.0;
    case ReducedLoad::kSine:
      break;
  }
  return std::sin(2.0 * M_PI * time);
}

double relative_displacement(const StudyBody& body, const Eigen::VectorXd& q) {
  const Eigen::VectorXd u = body.model.basis * q;
  const Eigen::Map<const Eigen::Matrix3Xd> vectors(u.data(), 3, u.size() / 3);
  return vectors.colwise().norm().maxCoeff() / body.size;
}

StudyBody make_study_body(const std::string& name, double share, double softer) {
  StudyBody body;
  body.example = example_body(name);
  body.example.material.young /= softer;
  const StvkBody full(body.example.mesh, body.example.material, body.example.fixed, name);
  const auto go_on = [](double, double, const std::string&) { return true; };
  body.model = *reduce(full, body.example.reduction, name, go_on);
  const Eigen::Matrix3Xd& x = body.model.mesh.vertices;
  body.size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff();
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, x.cols());
  forces.col(body.example.loaded) = body.example.load;
  body.direction = body.model.reduced_force(forces);
  const Eigen::VectorXd f = body.model.potential.lambda().cwiseSqrt() / (2.0 * M_PI);
  body.high = static_cast<int>((f.array() < 1.0 / (std::sqrt(softer) * kThesisStep)).count());
  for (int k = 0; k < 3; ++k) body.amplitudes[k] = calibrate(body, kReducedLoads[k], share);
  return body;
}

ReducedRun run_reduced(const StudyBody& body, const ReducedRunOptions& options,
                       const ReducedWatch& watch) {
  const SolverRegistry::Entry& entry =
      integrator_registry().find_for(options.integrator.name, "reduced");
  const auto solver = entry.make(
      parse_parameters(entry.parameters, options.integrator.parameters, options.integrator.name));
  ReducedSystem system(body.model.potential, {options.damping, 0.0});
  solver->prepare(system, options.h);
  const double bound = largest_coordinate(body);
  const auto steps = static_cast<std::uint64_t>(std::llround(options.duration / options.h));
  ReducedRun run;
  StepReport report;
  const Eigen::VectorXd direction = options.force * body.direction;
  const double start = working_seconds();
  for (run.steps = 0; run.steps < steps; ++run.steps) {
    const double time = static_cast<double>(run.steps) * options.h;
    system.force = load_at(options.load, time + 0.5 * options.h) * direction;
    report.warnings.clear();
    report.metrics.clear();
    solver->step(system, options.h, report);
    run.iterations += static_cast<std::uint64_t>(report.iterations);
    run.warned += report.warnings.empty() ? 0 : 1;
    if (!is_bounded(system.q, bound)) {
      run.blew_up = true;
      break;
    }
    run.end = time + options.h;
    if (watch && !watch(system, run.end)) break;
  }
  run.seconds = working_seconds() - start;
  run.q = system.q;
  run.p = system.p;
  return run;
}

}  // namespace pliant
