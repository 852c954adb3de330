#include "pliant/solvers/time/midpoint_rule.h"

#include "pliant/core/columns.h"

namespace pliant {

void MidpointRule::end_step(Particles& p) const {
  for_each_column(p.x, [&](int i) {
    if (p.is_fixed(i)) return;
    p.x.col(i) += p.x.col(i) - p.x_start.col(i);
    p.v.col(i) += p.v.col(i) - p.v_start.col(i);
  });
}

TimeIntegrationRegistry::Entry midpoint_rule_entry() {
  return {"midpoint",
          "second order, keeps energy and angular momentum where nothing touches; damps nothing",
          {},
          {"cloth", "patch", "viscoelastic"},
          [](const Parameters&) { return std::make_unique<MidpointRule>(); }};
}

}  // namespace pliant
