#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/accuracy_row.h"

namespace pliant {

/// What a row costs: the median time of a step, or that of a simulated second of a run [s].
double cost(const AccuracyRow& row);

/// What a row's error is at most, as far as the references can tell: that against one of them and
/// what they disagree by.
double sure_error(const AccuracyRow& row);

/// The row of least cost whose sure error is at most `error`, and none of whose steps' medians took
/// longer than `budget` [s]. The first of equals; empty when there is none.
std::optional<AccuracyRow> cheapest(const std::vector<AccuracyRow>& rows, Measure measure,
                                    double error,
                                    double budget = std::numeric_limits<double>::infinity());

/// The row of least sure error within `budget` [s], the cheapest of equals.
std::optional<AccuracyRow> most_accurate(const std::vector<AccuracyRow>& rows, Measure measure,
                                         double budget);

/// The key `solver` of a scene file, and where it names one `time_integration`.
std::string scene_snippet(const SolverSetting& solver);

}  // namespace pliant
