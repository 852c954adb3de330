#include "pliant/solvers/time/time_integrations.h"

#include "pliant/solvers/time/bdf2.h"
#include "pliant/solvers/time/midpoint_rule.h"

namespace pliant {
namespace {

/// What solvers do by themselves.
class ImplicitEulerIntegration final : public TimeIntegration {
 public:
  std::string_view name() const override { return kImplicitEuler; }
  bool is_first_order() const override { return true; }
  double begin_step(Particles& /*p*/, double dt) const override { return dt; }
};

TimeIntegrationRegistry::Entry implicit_euler_entry() {
  return {std::string(kImplicitEuler),
          "first order; damps motion the more, the larger the step is",
          {},
          {"cloth", "patch", "viscoelastic", "rigid"},
          [](const Parameters&) { return std::make_unique<ImplicitEulerIntegration>(); }};
}

}  // namespace

const TimeIntegrationRegistry& time_integrations() {
  static const TimeIntegrationRegistry registry = [] {
    TimeIntegrationRegistry built("time_integration");
    built.add(implicit_euler_entry());
    built.add(bdf2_entry());
    built.add(midpoint_rule_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
