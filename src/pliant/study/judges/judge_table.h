#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/study/judges/judge.h"

namespace pliant {

/// A figure beside its judge, or, where the judge failed, what it said.
struct JudgedRow {
  const Judge* judge = nullptr;
  JudgedFigure figure;
  double seconds = 0.0;  ///< of this thread, for all figures of the judge
  std::string failure;   ///< empty: it did not fail

  /// The error is beyond what the judge allows, or there is none.
  bool is_miss() const { return !(figure.error() <= judge->allowed); }
};

/// Runs judges and returns their rows, misses first and each group by the error over what is
/// allowed, the largest first. `go_on` is told how much is done, in [0, 1], and of which judge;
/// false: the rows are of the judges that ended before.
std::vector<JudgedRow> run_judges(
    const std::vector<const Judge*>& chosen, const std::string& folder,
    const std::function<bool(double done, const std::string& judge)>& go_on);

/// Misses first and each group by the error over what is allowed, the largest first.
void sort_rows(std::vector<JudgedRow>& rows);

/// The rows as a table in Markdown, padded so that it reads well in a terminal too.
std::string judge_table(const std::vector<JudgedRow>& rows);
/// The source and the set-up of each judge that has rows, and how long it took, one a line.
std::string judge_sources(const std::vector<JudgedRow>& rows);
/// With all digits.
std::string judge_csv(const std::vector<JudgedRow>& rows);

}  // namespace pliant
