#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pliant/study/generated/stability_study.h"

namespace pliant {
namespace {

struct Cell {
  int stable = 0, recovered = 0, refused = 0;
  std::map<std::string, int> failed;  // by oracle

  void add(const SceneOutcome& outcome) {
    stable += outcome.fate == SceneFate::kStable;
    recovered += outcome.fate == SceneFate::kRecovered;
    refused += outcome.fate == SceneFate::kRefused;
    if (outcome.fate == SceneFate::kFailed) ++failed[outcome.oracle];
  }
  std::string text() const {
    if (stable + recovered + refused == 0 && failed.empty()) return "";
    std::string all = fmt::format("{} {} {}", stable, recovered, refused);
    for (const auto& [oracle, count] : failed) all += fmt::format(" **{} {}**", count, oracle);
    return all;
  }
};

struct Cost {
  double energy = 0.0;
  std::vector<double> seconds;

  void add(const SceneOutcome& outcome) {
    if (outcome.fate != SceneFate::kStable && outcome.fate != SceneFate::kRecovered) return;
    energy = std::max(energy, outcome.energy);
    seconds.push_back(outcome.seconds);
  }
  std::string text() {
    if (seconds.empty()) return "| | | |";
    std::sort(seconds.begin(), seconds.end());
    return fmt::format("| {:.1f} % | {:.2g} ms | {:.2g} ms |", 100.0 * energy,
                       1e3 * seconds[seconds.size() / 2], 1e3 * seconds.back());
  }
};

std::vector<std::string> solvers_of(int model) {
  std::vector<std::string> solvers;
  const auto& names = scene_factors()[kFactorSolver].values;
  for (int k = 0; k < static_cast<int>(names.size()); ++k) {
    if (go_together(kFactorModel, model, kFactorSolver, k)) {
      solvers.push_back(names[static_cast<std::size_t>(k)]);
    }
  }
  return solvers;
}

std::string heading(const std::vector<std::string>& columns) {
  std::string text = "| solver |", line = "\n|---|";
  for (const std::string& column : columns) {
    text += " " + column + " |";
    line += "---|";
  }
  return text + line + "\n";
}

}  // namespace

std::string stability_tables(const std::vector<TriedScene>& scenes) {
  const auto& models = scene_factors()[kFactorModel].values;
  const auto& cases = scene_factors()[kFactorSurroundings].values;
  std::map<std::string, Cell> cells;
  std::map<std::string, Cost> costs;
  const auto key = [](const std::string& model, const std::string& solver) {
    return model + " " + solver;
  };
  for (const TriedScene& scene : scenes) {
    const std::string pair =
        key(value_of(scene.choice, kFactorModel), value_of(scene.choice, kFactorSolver));
    cells[pair + " " + value_of(scene.choice, kFactorSurroundings)].add(scene.outcome);
    costs[pair].add(scene.outcome);
  }
  std::string text;
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::vector<std::string> columns = cases;
    columns.insert(columns.end(), {"energy", "step", "longest step"});
    text += fmt::format("### {}\n\n{}", models[m], heading(columns));
    for (const std::string& solver : solvers_of(static_cast<int>(m))) {
      text += fmt::format("| `{}` |", solver);
      for (const std::string& surroundings : cases) {
        text += " " + cells[key(models[m], solver) + " " + surroundings].text() + " |";
      }
      text += costs[key(models[m], solver)].text().substr(1) + "\n";
    }
    text += "\n";
  }
  return text;
}

}  // namespace pliant
