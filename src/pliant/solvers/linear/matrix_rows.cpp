#include "pliant/solvers/linear/matrix_rows.h"

namespace pliant {

void append_springs(const PointConstraintRows& rows, const Eigen::VectorXd& mobility,
                    HeldRows& springs) {
  for (int r = 0; r < rows.size(); ++r) {
    springs.begin_row(1.0 / rows.compliance(r));
    for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
      if (mobility[e->particle] > 0.0) springs.add(e->particle, e->weight * rows.direction(r));
    }
  }
  if (!rows.ties().empty()) springs.reserve_more(static_cast<std::size_t>(mobility.size()));
  for (const PointConstraintRows::Tie& tie : rows.ties()) {
    springs.begin_row(1.0 / tie.compliance);
    for (const auto* g = rows.begin(tie); g != rows.end(tie); ++g) {
      if (mobility[g->particle] > 0.0) springs.add(g->particle, g->value);
    }
  }
}

void append_springs(const ConstraintRows& rows, const Eigen::VectorXd& mobility,
                    HeldRows& springs) {
  for (int r = 0; r < rows.size(); ++r) {
    double own = 0.0;
    for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
      own += e->gradient.squaredNorm() * mobility[e->particle];
    }
    springs.begin_row(own > 0.0 ? 1.0 / (own + rows.compliance(r)) : 0.0);
    for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
      if (mobility[e->particle] > 0.0) springs.add(e->particle, e->gradient);
    }
  }
}

}  // namespace pliant
