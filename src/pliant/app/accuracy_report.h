#pragma once

#include <string>
#include <vector>

#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/accuracy_row.h"

namespace pliant {

/// What a study found, for a terminal: a table of every row, how well the references agree, and
/// the cheapest solver for each of some errors.
std::string accuracy_report(const AccuracyPlan& plan, const std::vector<AccuracyRow>& rows);

}  // namespace pliant
