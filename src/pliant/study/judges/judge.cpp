#include "pliant/study/judges/judge.h"

#include <cmath>

namespace pliant {
namespace {

double error_of(double ours, double reference) {
  const double error = std::abs(ours - reference) / std::abs(reference);
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

}  // namespace

double JudgedFigure::error() const { return error_of(ours, reference); }
double JudgedFigure::coarser_error() const { return error_of(coarser, reference); }

const std::vector<Judge>& judges() {
  static const std::vector<Judge> all = {cooks_membrane_judge(),
                                         hertz_judge(),
                                         torsion_judge(),
                                         twisting_column_judge(),
                                         elastic_flag_statics_judge(),
                                         elastic_flag_judge(),
                                         liquid_at_rest_judge(),
                                         dam_break_front_judge(),
                                         dam_break_pressure_judge(),
                                         fabric_cantilever_judge(),
                                         drape_judge()};
  return all;
}

}  // namespace pliant
