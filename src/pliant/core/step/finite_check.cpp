#include "pliant/core/step/finite_check.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

bool all_below(const Eigen::Matrix3Xd& values, double limit) {
  const double* data = values.data();
  const auto bad_within = [&](int begin, int end) {
    int bad = 0;
    // Written so that NaN counts as bad and the loop has no early exit to hinder vectorisation.
    for (Eigen::Index k = 3 * Eigen::Index{begin}; k < 3 * Eigen::Index{end}; ++k) {
      bad |= !(std::abs(data[k]) <= limit);
    }
    return bad;
  };
  return parallel_reduce(0, static_cast<int>(values.cols()), kColumnGrain, bad_within,
                         [](int a, int b) { return a | b; }) == 0;
}

bool began_finite(const Particles& particles, int i) {
  return particles.x_start.col(i).allFinite() && particles.v_start.col(i).allFinite();
}

std::string text(const Eigen::Vector3d& value) {
  return fmt::format("({:g}, {:g}, {:g})", value.x(), value.y(), value.z());
}

}  // namespace

std::optional<int> FiniteCheck::first_bad(const Particles& particles) const {
  if (all_below(particles.x, max_distance) && all_below(particles.v, max_speed)) return {};
  // Within a step a bad vertex spoils its neighbours: the cause is the one that began bad.
  for (int i = 0; i < particles.size(); ++i) {
    if (!began_finite(particles, i)) return i;
  }
  for (int i = 0; i < particles.size(); ++i) {
    if (!all_below(particles.x.col(i), max_distance) || !all_below(particles.v.col(i), max_speed)) {
      return i;
    }
  }
  return {};
}

std::string FiniteCheck::message(const Particles& particles, int bad, const std::string& body,
                                 const std::string& solver, double time, double dt) const {
  if (!began_finite(particles, bad)) {
    return fmt::format(
        "body '{}', vertex {}: was not finite when the step began (position {} m, velocity {} "
        "m/s); "
        "the step to {:.6f} s was undone. No solver mends that: reset the body.",
        body, bad, text(particles.x_start.col(bad)), text(particles.v_start.col(bad)), time);
  }
  return fmt::format(
      "body '{}', vertex {}: position {} m, velocity {} m/s at {:.6f} s (limits: {:g} m, {:g} "
      "m/s); the step was undone. Try a time step smaller than {:g} s, more iterations, or another "
      "solver than '{}'.",
      body, bad, text(particles.x.col(bad)), text(particles.v.col(bad)), time, max_distance,
      max_speed, dt, solver);
}

}  // namespace pliant
