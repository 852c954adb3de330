#include "pliant/study/generated/stability_study.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <iterator>
#include <list>
#include <map>
#include <set>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"
#include "pliant/study/generated/scene_child.h"

namespace pliant {
namespace {

SceneOutcome try_in_child(const SceneChoice& choice, const std::string& robot) {
  SceneChild child(0, choice, robot);
  for (;;) {
    if (const auto outcome = child.read()) return *outcome;
  }
}

/// Waits until some of the children can be read.
void wait_for(const std::list<SceneChild>& children) {
  std::vector<pollfd> waiting;
  for (const SceneChild& child : children) waiting.push_back({child.descriptor(), POLLIN, 0});
  poll(waiting.data(), waiting.size(), -1);
}

bool is_ready(const SceneChild& child) {
  pollfd one{child.descriptor(), POLLIN, 0};
  return poll(&one, 1, 0) > 0;
}

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return '"' + text + '"';
}

std::string rows_of(const std::vector<TriedScene>& scenes) {
  std::string text = "fate,oracle,energy,seconds,message";
  for (const SceneFactor& factor : scene_factors()) text += "," + factor.name;
  text += "\n";
  for (const TriedScene& scene : scenes) {
    const SceneOutcome& outcome = scene.outcome;
    text += fmt::format("{},{},{:.4g},{:.4g},{}", to_string(outcome.fate), outcome.oracle,
                        outcome.energy, outcome.seconds, quoted(outcome.message));
    for (int f = 0; f < kFactorCount; ++f) {
      text += "," + value_of(scene.choice, static_cast<Factor>(f));
    }
    text += "\n";
  }
  return text;
}

/// One of each oracle, model and solver is shrunk: of a defect there are often hundreds.
void write_failures(const std::vector<TriedScene>& scenes, const StabilityOptions& options,
                    const StabilityProgress& progress) {
  std::set<std::string> kinds;
  for (const TriedScene& scene : scenes) {
    const std::string& oracle = scene.outcome.oracle;
    if (scene.outcome.fate != SceneFate::kFailed) continue;
    const std::string kind = fmt::format("{}_{}_{}", oracle, value_of(scene.choice, kFactorModel),
                                         value_of(scene.choice, kFactorSolver));
    if (!kinds.insert(kind).second) continue;
    const auto count = static_cast<int>(scenes.size());
    if (!progress(count, count)) return;
    const SceneChoice smallest = shrink(scene.choice, [&](const SceneChoice& simpler) {
      return try_in_child(simpler, options.robot).oracle == oracle;
    });
    write_file_atomically(options.folder + "/" + kind + ".scene",
                          corpus_text(smallest, scene.outcome));
  }
}

}  // namespace

std::string corpus_text(const SceneChoice& choice, const SceneOutcome& outcome) {
  std::string message = outcome.message;
  std::replace(message.begin(), message.end(), '\n', ' ');
  return fmt::format("# {}: {}\n{}\n", outcome.oracle, message, choice_text(choice));
}

std::vector<TriedScene> study_stability(const StabilityOptions& options,
                                        const StabilityProgress& progress) {
  const std::vector<SceneChoice> plan = plan_scenes(options.scenes, options.seed);
  std::map<int, SceneOutcome> outcomes;
  std::list<SceneChild> children;
  const auto count = static_cast<int>(plan.size());
  bool goes_on = true;
  for (int begun = 0; goes_on && static_cast<int>(outcomes.size()) < count;) {
    while (begun < count && static_cast<int>(children.size()) < options.jobs) {
      children.emplace_back(begun, plan[static_cast<std::size_t>(begun)], options.robot);
      ++begun;
    }
    wait_for(children);
    for (auto child = children.begin(); child != children.end();) {
      const auto outcome = is_ready(*child) ? child->read() : std::nullopt;
      if (outcome) outcomes[child->index()] = *outcome;
      child = outcome ? children.erase(child) : std::next(child);
    }
    goes_on = progress(static_cast<int>(outcomes.size()), count);
  }
  std::vector<TriedScene> scenes;
  for (const auto& [index, outcome] : outcomes) {
    scenes.push_back({plan[static_cast<std::size_t>(index)], outcome});
  }
  write_file_atomically(options.folder + "/scenes.csv", rows_of(scenes));
  write_file_atomically(options.folder + "/stability.md", stability_tables(scenes));
  if (goes_on) write_failures(scenes, options, progress);
  return scenes;
}

}  // namespace pliant
