#include "pliant/study/accuracy/accuracy_row.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "pliant/math/error.h"

namespace pliant {
namespace {

struct Column {
  const char* name;
  double AccuracyRow::*value;
};

/// After those that are no doubles.
constexpr std::array<Column, 16> kColumns = {
    {{"dt_s", &AccuracyRow::time_step},
     {"error", &AccuracyRow::error},
     {"median_error", &AccuracyRow::median_error},
     {"rms_m", &AccuracyRow::rms},
     {"largest_m", &AccuracyRow::largest},
     {"energy_error", &AccuracyRow::energy_error},
     {"strain_error", &AccuracyRow::strain_error},
     {"residual", &AccuracyRow::residual},
     {"used_iterations", &AccuracyRow::used_iterations},
     {"states", &AccuracyRow::states},
     {"disagreement", &AccuracyRow::disagreement},
     {"step_s", &AccuracyRow::step_seconds},
     {"longest_step_s", &AccuracyRow::longest_seconds},
     {"s_per_simulated_s", &AccuracyRow::seconds_per_second},
     {"wall_step_s", &AccuracyRow::wall_seconds},
     {"prepare_s", &AccuracyRow::prepare_seconds}}};
constexpr std::size_t kTextColumns = 5;
constexpr double kMostIterations = 1e6;  // as solvers allow

std::string header() {
  std::string line = "measure,solver,time_integration,iterations,status";
  for (const Column& column : kColumns) line += std::string(",") + column.name;
  return line;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

/// Infinite errors are legal; empty text or letters are not.
double number_of(const std::string& cell, const std::string& where) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0') {
    throw InputError(
        fmt::format("{}: '{}' is no number; this file was changed by hand", where, cell));
  }
  return value;
}

/// Of a setting; 0 where there is none.
int iterations_of(const std::string& cell, const std::string& where) {
  if (cell.empty()) return 0;
  const double value = number_of(cell, where);
  if (!(value >= 0.0 && value <= kMostIterations) || value != std::floor(value)) {
    throw InputError(fmt::format(
        "{}: '{}' is no number of iterations; this file was changed by hand", where, cell));
  }
  return static_cast<int>(value);
}

AccuracyRow row_of(const std::vector<std::string>& cells, const std::string& where) {
  const bool known = cells.size() == kTextColumns + kColumns.size() &&
                     (cells[0] == "step" || cells[0] == "run") &&
                     (cells[4] == "ok" || cells[4] == "not_finite");
  if (!known) {
    throw InputError(where +
                     ": this is no row of an accuracy study; remove the file, or choose "
                     "another --out");
  }
  AccuracyRow row;
  row.measure = cells[0] == "step" ? Measure::kStep : Measure::kRun;
  row.solver = cells[1];
  row.time_integration = cells[2];
  row.iterations = iterations_of(cells[3], where);
  row.is_finite = cells[4] == "ok";
  for (std::size_t k = 0; k < kColumns.size(); ++k) {
    row.*kColumns[k].value = number_of(cells[kTextColumns + k], where);
  }
  return row;
}

}  // namespace

std::string to_string(Measure measure) { return measure == Measure::kStep ? "step" : "run"; }

std::string to_csv(const std::vector<AccuracyRow>& rows) {
  std::string text = header() + "\n";
  for (const AccuracyRow& row : rows) {
    text += fmt::format("{},{},{},{},{}", to_string(row.measure), row.solver, row.time_integration,
                        row.iterations == 0 ? "" : std::to_string(row.iterations),
                        row.is_finite ? "ok" : "not_finite");
    for (const Column& column : kColumns) text += fmt::format(",{}", row.*column.value);
    text += "\n";
  }
  return text;
}

std::vector<AccuracyRow> rows_from_csv(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  std::string line;
  if (!std::getline(stream, line) || line != header()) {
    throw InputError(file +
                     ":1: this is no table of an accuracy study; remove the file, or choose "
                     "another --out");
  }
  std::vector<AccuracyRow> rows;
  for (int number = 2; std::getline(stream, line); ++number) {
    rows.push_back(row_of(cells_of(line), fmt::format("{}:{}", file, number)));
  }
  return rows;
}

}  // namespace pliant
