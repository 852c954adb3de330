#include "pliant/models/reduced/integrators/integrator.h"

#include <limits>

namespace pliant {
namespace {

// Small enough for any body to be linear, large enough for its energy, about the square, to be a
// number.
constexpr double kTinyForce = 1e-12;

}  // namespace

void Integrator::measure_response(ReducedSystem& system, double h) {
  const Eigen::VectorXd q = system.q, p = system.p, force = system.force;
  system.q.setZero();
  system.p.setZero();
  system.force.setConstant(kTinyForce);
  StepReport report;
  prepare_step(system, h);
  advance(system, h, report);
  response_.q = (system.q / kTinyForce).cwiseMax(0.0);
  response_.p = system.p / kTinyForce;
  system.q = q;
  system.p = p;
  system.force = force;
}

void Integrator::prepare(System& base, double dt) {
  auto& system = dynamic_cast<ReducedSystem&>(base);
  measure_response(system, dt);
  prepare_step(system, dt);
  system.take_response(response_);
}

void Integrator::step(System& base, double dt, StepReport& report) {
  report.solver = name();
  auto& system = dynamic_cast<ReducedSystem&>(base);
  system.begin_step(dt);
  system.known_elastic = std::numeric_limits<double>::quiet_NaN();
  advance(system, dt, report);
  system.end_step(dt, response_, report);
}

}  // namespace pliant
