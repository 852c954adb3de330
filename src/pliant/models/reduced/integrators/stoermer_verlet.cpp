#include "pliant/models/reduced/integrators/stoermer_verlet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pliant {

void StoermerVerlet::prepare_step(const ReducedSystem& system, double h) {
  drift_ = (1.0 + 0.5 * h * system.damping_rates().array()).inverse();
  known_q_.resize(0);
  unstable_.clear();
  const double longest = 2.0 / std::sqrt(std::max(0.0, system.potential.lambda().maxCoeff()));
  if (h < longest) return;
  unstable_ = fmt::format(
      "unstable_step: steps of {:.3g} s are too long for 'stoermer_verlet', which needs less than "
      "{:.2g} s for this body: take such a time step, or 'trigonometric'",
      h, longest);
}

void StoermerVerlet::advance(ReducedSystem& system, double h, StepReport& report) {
  if (!unstable_.empty()) report.warn(unstable_);
  // The force at the end of a step is that at the beginning of the next.
  if (known_q_.size() == 0 || known_q_ != system.q) system.potential.evaluate(system.q, r_, space_);
  system.p += 0.5 * h * (system.force - r_);
  const auto v = drift_.cwiseProduct(system.p);
  system.q += h * v;
  system.p = 2.0 * v - system.p;
  system.potential.evaluate(system.q, r_, space_);
  system.p += 0.5 * h * (system.force - r_);
  known_q_ = system.q;
  report.iterations = 1;
  report.ended_by = EndedBy::kDirect;
}

SolverRegistry::Entry StoermerVerlet::entry() {
  return {"stoermer_verlet",
          "explicit, symplectic, second order; stable for h w < 2 only",
          {},
          {"reduced"},
          [](const Parameters&) { return std::make_unique<StoermerVerlet>(); }};
}

}  // namespace pliant
