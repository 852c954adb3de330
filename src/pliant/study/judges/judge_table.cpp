#include "pliant/study/judges/judge_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "pliant/study/experiments/reduced_run.h"

namespace pliant {
namespace {

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100.0 * share) : "-";
}

std::string number_text(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "none";
}

/// Code points of UTF-8: what a terminal shows.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string table_of(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines[0].size(), 3);
  for (const auto& line : lines) {
    for (std::size_t k = 0; k < line.size(); ++k)
      widths[k] = std::max(widths[k], width_of(line[k]));
  }
  std::string text;
  for (std::size_t n = 0; n < lines.size(); ++n) {
    for (std::size_t k = 0; k < widths.size(); ++k) {
      text += (k == 0 ? "| " : " | ") + lines[n][k] +
              std::string(widths[k] - width_of(lines[n][k]), ' ');
    }
    text += " |\n";
    if (n > 0) continue;
    for (const std::size_t width : widths) text += "|" + std::string(width + 2, '-');
    text += "|\n";
  }
  return text;
}

std::vector<JudgedRow> rows_of(const Judge& judge, const JudgeOptions& options) {
  const double begin = working_seconds();
  std::vector<JudgedRow> rows;
  try {
    for (const JudgedFigure& figure : judge.run(options)) rows.push_back({&judge, figure, 0.0, {}});
  } catch (const std::exception& error) {
    rows = {{&judge, {"all", "", 1.0}, 0.0, error.what()}};
  }
  for (JudgedRow& row : rows) row.seconds = working_seconds() - begin;
  return rows;
}

}  // namespace

std::vector<JudgedRow> run_judges(
    const std::vector<const Judge*>& chosen, const std::string& folder,
    const std::function<bool(double done, const std::string& judge)>& go_on) {
  std::vector<JudgedRow> rows;
  const auto count = static_cast<double>(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    bool goes_on = true;
    JudgeOptions options;
    options.folder = folder;
    options.go_on = [&](double done) {
      goes_on = goes_on && go_on((static_cast<double>(k) + done) / count, chosen[k]->name);
      return goes_on;
    };
    if (!options.go_on(0.0)) break;
    const std::vector<JudgedRow> own = rows_of(*chosen[k], options);
    if (!goes_on) break;
    rows.insert(rows.end(), own.begin(), own.end());
  }
  sort_rows(rows);
  return rows;
}

void sort_rows(std::vector<JudgedRow>& rows) {
  const auto share = [](const JudgedRow& row) { return row.figure.error() / row.judge->allowed; };
  std::stable_sort(rows.begin(), rows.end(), [&](const JudgedRow& a, const JudgedRow& b) {
    return share(a) > share(b);  // a miss has a share above 1
  });
}

std::string judge_table(const std::vector<JudgedRow>& rows) {
  std::vector<std::vector<std::string>> lines = {{"", "judge", "figure", "unit", "reference",
                                                  "ours", "error", "allowed",
                                                  "at half the resolution"}};
  for (const JudgedRow& row : rows) {
    const JudgedFigure& figure = row.figure;
    lines.push_back({row.is_miss() ? "**miss**" : "", row.judge->name,
                     row.failure.empty() ? figure.quantity : "failed: " + row.failure, figure.unit,
                     row.failure.empty() ? number_text(figure.reference) : "",
                     number_text(figure.ours), percent(figure.error()), percent(row.judge->allowed),
                     percent(figure.coarser_error())});
  }
  return table_of(lines);
}

std::string judge_sources(const std::vector<JudgedRow>& rows) {
  std::vector<std::vector<std::string>> lines = {{"judge", "set up as", "source", "time"}};
  for (const Judge& judge : judges()) {
    const auto own = std::find_if(rows.begin(), rows.end(),
                                  [&](const JudgedRow& row) { return row.judge == &judge; });
    if (own == rows.end()) continue;
    lines.push_back(
        {judge.name, judge.set_up, judge.source, fmt::format("{:.2g} s", own->seconds)});
  }
  return table_of(lines);
}

std::string judge_csv(const std::vector<JudgedRow>& rows) {
  std::string text = "judge,figure,unit,reference,ours,error,allowed,coarser,is_miss,seconds\n";
  for (const JudgedRow& row : rows) {
    const JudgedFigure& figure = row.figure;
    text += fmt::format("{},\"{}\",{},{},{},{:.6g},{},{},{},{:.3g}\n", row.judge->name,
                        figure.quantity, figure.unit, figure.reference, figure.ours, figure.error(),
                        row.judge->allowed, figure.coarser, row.is_miss() ? 1 : 0, row.seconds);
  }
  return text;
}

}  // namespace pliant
