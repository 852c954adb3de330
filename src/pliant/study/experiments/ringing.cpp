#include "pliant/study/experiments/ringing.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pliant/models/reduced/integrators/integrator.h"

namespace pliant {
namespace {

/// The amplitude of the line at so many radians a sample, by Hann's window.
double line_at(const std::vector<double>& series, double angle) {
  const auto count = static_cast<double>(series.size());
  const std::complex<double> turn = std::polar(1.0, -angle);
  std::complex<double> sum = 0.0, now = 1.0;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double window = 1.0 - std::cos(2.0 * M_PI * (static_cast<double>(k) + 0.5) / count);
    sum += window * series[k] * now;
    now *= turn;
  }
  return 2.0 * std::abs(sum) / count;
}

/// The angle of the strongest line. A body that rings strongly about a bent mean has one at 0 too,
/// as wide as the window makes it, which is none.
double strongest(const std::vector<double>& series) {
  const double spacing = M_PI / static_cast<double>(series.size());
  const double lowest = 6.0 * spacing;
  double best = lowest, most = 0.0;
  for (double angle = lowest; angle < M_PI; angle += spacing) {
    const double line = line_at(series, angle);
    if (line > most) {
      most = line;
      best = angle;
    }
  }
  double low = best - spacing, high = best + spacing;
  for (int k = 0; k < 30; ++k) {  // golden section, to 1e-6 of the spacing
    const double third = 0.381966 * (high - low);
    if (line_at(series, low + third) < line_at(series, high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  return 0.5 * (low + high);
}

/// Largest displacement of a vertex where the coordinate is 1.
double reach(const StudyBody& body, int coordinate) {
  const Eigen::VectorXd column = body.model.basis.col(coordinate);
  const Eigen::Map<const Eigen::Matrix3Xd> vectors(column.data(), 3, column.size() / 3);
  return vectors.colwise().norm().maxCoeff();
}

}  // namespace

Ringing ring(const StudyBody& body, const RingingOptions& options) {
  const SolverRegistry::Entry& entry =
      integrator_registry().find_for(options.integrator.name, "reduced");
  const auto solver = entry.make(
      parse_parameters(entry.parameters, options.integrator.parameters, options.integrator.name));
  ReducedSystem system(body.model.potential);
  const double omega = std::sqrt(body.model.potential.lambda()[options.coordinate]);
  const double extent = options.share * body.size / reach(body, options.coordinate);
  system.p[options.coordinate] = omega * extent;
  solver->prepare(system, options.h);
  const auto every = std::llround(kThesisStep / options.h);
  const auto steps = static_cast<long>(options.duration / options.h);
  Ringing ringing;
  std::vector<double> series;
  StepReport report;
  const double start = working_seconds();
  long step = 0;
  while (step < steps && !ringing.blew_up) {
    report.warnings.clear();
    report.metrics.clear();
    solver->step(system, options.h, report);
    if (++step % every == 0) series.push_back(system.q[options.coordinate]);
    ringing.blew_up = !(system.q.cwiseAbs().maxCoeff() < 1e3 * extent);
  }
  ringing.step_seconds = (working_seconds() - start) / static_cast<double>(step);
  if (ringing.blew_up) return ringing;
  const double angle = strongest(series);
  ringing.frequency = angle / (2.0 * M_PI * kThesisStep);
  ringing.amplitude = line_at(series, angle);
  return ringing;
}

}  // namespace pliant
