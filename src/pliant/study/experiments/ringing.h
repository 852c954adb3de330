#pragma once

#include "pliant/study/experiments/reduced_run.h"

namespace pliant {

/// How a coordinate of a body rings after a blow that starts it alone.
struct Ringing {
  double frequency = 0.0;  ///< of its strongest line [Hz]
  double amplitude = 0.0;  ///< of that line [kg^½ m]
  bool blew_up = false;
  double step_seconds = 0.0;  ///< working time of a step [s]
};

struct RingingOptions {
  StudyIntegrator integrator;
  int coordinate = 0;
  double share = 0.001;    ///< largest displacement over the body's size, were the body linear
  double h = kThesisStep;  ///< kThesisStep over a whole number
  double duration = 2.0;   ///< [s]
};

/// The coordinate is looked at once in kThesisStep, so that lines up to half of 1/kThesisStep are
/// told apart.
Ringing ring(const StudyBody& body, const RingingOptions& options);

}  // namespace pliant
