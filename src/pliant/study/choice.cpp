#include "pliant/study/choice.h"

#include <fmt/format.h>

namespace pliant {
namespace {

bool is_candidate(const AccuracyRow& row, Measure measure, double budget) {
  return row.measure == measure && row.is_finite && row.longest_seconds <= budget;
}

/// Keeps `row` when there is no best one yet or `is_better` prefers it.
template <class Compare>
void keep_best(const AccuracyRow& row, const Compare& is_better, std::optional<AccuracyRow>& best) {
  if (!best || is_better(row, *best)) best = row;
}

}  // namespace

double cost(const AccuracyRow& row) {
  return row.measure == Measure::kStep ? row.step_seconds : row.seconds_per_second;
}

double sure_error(const AccuracyRow& row) { return row.error + row.disagreement; }

std::optional<AccuracyRow> cheapest(const std::vector<AccuracyRow>& rows, Measure measure,
                                    double error, double budget) {
  const auto is_cheaper = [](const AccuracyRow& a, const AccuracyRow& b) {
    return cost(a) < cost(b);
  };
  std::optional<AccuracyRow> best;
  for (const AccuracyRow& row : rows) {
    if (is_candidate(row, measure, budget) && sure_error(row) <= error) {
      keep_best(row, is_cheaper, best);
    }
  }
  return best;
}

std::optional<AccuracyRow> most_accurate(const std::vector<AccuracyRow>& rows, Measure measure,
                                         double budget) {
  const auto is_more_accurate = [](const AccuracyRow& a, const AccuracyRow& b) {
    const double ea = sure_error(a), eb = sure_error(b);
    return ea < eb || (ea == eb && cost(a) < cost(b));
  };
  std::optional<AccuracyRow> best;
  for (const AccuracyRow& row : rows) {
    if (is_candidate(row, measure, budget)) keep_best(row, is_more_accurate, best);
  }
  return best;
}

std::string scene_snippet(const SolverSetting& solver) {
  std::string text;
  if (!solver.time_integration.empty()) {
    text += fmt::format("time_integration: {}\n", solver.time_integration);
  }
  text += fmt::format("solver:\n  name: {}\n", solver.name);
  for (const auto& [name, value] : solver.parameters)
    text += fmt::format("  {}: {}\n", name, value);
  return text;
}

}  // namespace pliant
