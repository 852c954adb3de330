#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/models/reduced/files/example_bodies.h"
#include "pliant/models/reduced/reduced_system.h"

namespace pliant {

/// The thesis's three forces: for 0.003 s, for 0.3 s, and a sine of 1 Hz.
enum class ReducedLoad { kImpulse, kConstant, kSine };
constexpr ReducedLoad kReducedLoads[] = {ReducedLoad::kImpulse, ReducedLoad::kConstant,
                                         ReducedLoad::kSine};
std::string to_string(ReducedLoad load);
/// Share of the amplitude at a time [s].
double load_at(ReducedLoad load, double time);

/// A body of a study: its reduced model, where it is pulled, and how strongly.
struct StudyBody {
  ExampleBody example;
  ReducedModel model;
  Eigen::VectorXd direction;  ///< Uᵀ f of 1 N on the loaded vertex
  double size = 0.0;          ///< largest extent [m]
  double amplitudes[3] = {};  ///< of each load [N]; see calibrate()
  int high = 0;  ///< coordinates from this one on have f >= 1/(h √softer), h = 0.003 s
};

/// Time that this thread has worked [s]: what else the machine does counts little.
double working_seconds();

/// The thesis's time step [s].
constexpr double kThesisStep = 0.003;

/// Reduces the example and finds, for each load, the force at which the largest displacement of any
/// vertex within 2 s is `share` of the body's size (converged midpoint rule, no damping). Young's
/// modulus is 1/softer of the example's.
StudyBody make_study_body(const std::string& name, double share, double softer = 1.0);

/// One integrator with its parameters, and a name for tables.
struct StudyIntegrator {
  std::string label;
  std::string name;
  ParameterText parameters;
};

struct ReducedRunOptions {
  StudyIntegrator integrator;
  ReducedLoad load = ReducedLoad::kConstant;
  double force = 0.0;    ///< amplitude [N]
  double damping = 0.0;  ///< α [1/s]
  double h = kThesisStep;
  double duration = 30.0;  ///< [s]
};

struct ReducedRun {
  double end = 0.0;  ///< simulated time that was reached before it blew up [s]
  bool blew_up = false;
  std::uint64_t steps = 0;
  std::uint64_t iterations = 0;  ///< Newton iterations, or parts of trigonometric's steps
  std::uint64_t warned = 0;      ///< steps with a warning
  double seconds = 0.0;          ///< working time of all steps
  Eigen::VectorXd q, p;          ///< at the end
};

/// What a run calls after each step; false ends it.
using ReducedWatch = std::function<bool(const ReducedSystem& system, double time)>;

/// Runs until the duration is over, the watch asks to stop, or the state blows up: not finite, or
/// a coordinate whose motion would be a hundred times the body's size.
ReducedRun run_reduced(const StudyBody& body, const ReducedRunOptions& options,
                       const ReducedWatch& watch = {});

/// Largest displacement of a vertex at q over the body's size.
double relative_displacement(const StudyBody& body, const Eigen::VectorXd& q);

}  // namespace pliant
