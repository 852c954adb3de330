#include "pliant/study/generated/generated_oracles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "pliant/study/generated/generated_body.h"

namespace pliant {
namespace {

// Positions of 1 m round by 1e-16 m in each of some hundred updates, and 100 times that far away;
// the equations of the hardest bodies multiply that by up to 1e5. What comes of it through the
// scene itself is measured by nudging it.
constexpr double kRoundOff = 1e-7;  // of a body's size
// A nudge is 1e5 times round-off; a tenth of what it brings is more than round-off can.
constexpr double kOfNudged = 10.0;
constexpr double kOfLost = 2.0;     // of the travel, where a step says that it is not right
constexpr double kAtRest = 1e-9;    // of a body's size
constexpr double kMomentum = 1e-9;  // of all particles' without their signs
constexpr double kEnergy = 0.05;    // of what there is
constexpr double kSlowest = 1e-5;   // speed whose energy is nothing, sizes a second
constexpr double kFallen = 0.2;     // sizes through which gravity's work is counted as there
// The pressure of a liquid is not counted as energy: half the square of by how much it is pressed,
// times that of the speed of sound. So much is there from the start, where particles of a grid are
// a little too near each other at the surface, and comes when it hits something.
constexpr double kPressed = 0.1;
constexpr double kDeep = 0.02;  // of a body's size, between the points that touch
// Of what steps change that are twice as long: methods of first order halve it.
constexpr double kOfLonger = 0.75;
constexpr double kRounded = 1e-13;  // of a position, in some dozens of steps
// Shares of the distance that a scene came: an error above the first one has to be told of, and a
// warning is of more than the second one.
constexpr double kUntold = 0.05, kNeedless = 0.02;
constexpr double kLeastTravel = 0.01;  // of a body's size
// Between references, likewise.
constexpr double kDisagreement = 0.5 * kNeedless;

std::string compare(const GeneratedRun& here, const GeneratedRun& there,
                    const SceneTelling& telling, double tolerance) {
  if (here.is_built != there.is_built || here.refusal.empty() != there.refusal.empty()) {
    return fmt::format("one is refused, the other is not: '{}', '{}'", here.refusal, there.refusal);
  }
  if (!here.refusal.empty()) return "";
  if (here.points.cols() != there.points.cols() || here.points.cols() == 0)
    return "another number of points";
  const Positions back = (telling.place.inverse() * there.points) / telling.length;
  const double off = (back - here.points).colwise().norm().maxCoeff();
  if (off <= tolerance) return "";
  return fmt::format("{:.3g} m off, and {:.3g} m are allowed", off, tolerance);
}

bool was_run(const GeneratedRun& run) { return run.is_built || !run.refusal.empty(); }

/// How far a telling may be off [m].
double tolerance_of(const SceneChoice& choice, const SceneRuns& runs) {
  const double size = facts_of(choice).size;
  double grown = 0.0;
  if (runs.nudged.is_built && runs.nudged.points.cols() == runs.here.points.cols()) {
    grown = (runs.nudged.points - runs.here.points).colwise().norm().maxCoeff();
  }
  const double lost = runs.here.is_lost ? kOfLost * runs.here.travel : 0.0;
  return kRoundOff * size + kOfNudged * grown + lost;
}

double energy_scale(const SceneFacts& facts, const GeneratedRun& run) {
  const double gravity = facts.has_gravity ? kGeneratedGravity : 0.0;
  const double slowest = kSlowest * facts.size;
  const double pressed = facts.has_liquid ? kPressed * kGeneratedSound * kGeneratedSound : 0.0;
  return run.energy_start +
         run.mass * (gravity * kFallen * facts.size + slowest * slowest + pressed);
}

std::string check_finite(const SceneChoice&, const SceneRuns& runs) {
  return runs.here.is_finite ? "" : "positions or velocities are not finite";
}

std::string check_reason(const SceneChoice&, const SceneRuns& runs) {
  return runs.here.refusal == "?" ? "a step was not taken, and nothing says why" : "";
}

std::string check_time(const SceneChoice&, const SceneRuns& runs) {
  if (runs.here.seconds <= kSceneSeconds) return "";
  return fmt::format("{} steps took {:.1f} s", runs.here.steps, runs.here.seconds);
}

std::string check_bytes(const SceneChoice&, const SceneRuns& runs) {
  const char* const how[] = {"once more, on 2 threads", "on 4 threads"};
  for (std::size_t k = 0; k < runs.again.size(); ++k) {
    const GeneratedRun& run = runs.again[k];
    if (run.hash == runs.here.hash && run.state == runs.here.state &&
        run.refusal == runs.here.refusal) {
      continue;
    }
    return fmt::format("other bits {}", how[k]);
  }
  return "";
}

std::string check_rest(const SceneChoice& choice, const SceneRuns& runs) {
  const SceneFacts facts = facts_of(choice);
  if (!facts.is_quiet || !runs.here.refusal.empty()) return "";
  if (runs.here.travel <= kAtRest * facts.size) return "";
  return fmt::format("it moves by {:.3g} m, and nothing moves it", runs.here.travel);
}

std::string check_momentum(const SceneChoice& choice, const SceneRuns& runs) {
  const SceneFacts facts = facts_of(choice);
  if (facts.loses_momentum || facts.has_obstacles || facts.is_held) return "";
  const GeneratedRun& run = runs.here;
  // Velocities are differences of positions, which round, over a step.
  const double rounding = 1e-15 * run.reach / facts.time_step;
  const double scale = run.momentum_scale + run.mass * rounding / kMomentum;
  if (run.momentum_missing <= kMomentum * scale) return "";
  return fmt::format("{:.3g} of the momentum is missing", run.momentum_missing / scale);
}

std::string check_energy(const SceneChoice& choice, const SceneRuns& runs) {
  const SceneFacts facts = facts_of(choice);
  if (facts.is_pushed || facts.begins_beyond_limit) return "";
  const bool is_told = runs.here.is_warned || !runs.here.refusal.empty();
  if (facts.may_blow_up && is_told) return "";
  const double scale = energy_scale(facts, runs.here);
  if (runs.here.energy_gained <= kEnergy * scale) return "";
  return fmt::format("{:.3g} J more than at the start, and there were {:.3g} J",
                     runs.here.energy_gained, scale);
}

std::string check_passing(const SceneChoice& choice, const SceneRuns& runs) {
  if (runs.here.depth <= kDeep * facts_of(choice).size) return "";
  return fmt::format("{:.3g} m deep in what it touches", runs.here.depth);
}

std::string check_turned(const SceneChoice& choice, const SceneRuns& runs) {
  return compare(runs.here, runs.turned, runs.turned_telling, tolerance_of(choice, runs));
}

std::string check_rescaled(const SceneChoice& choice, const SceneRuns& runs) {
  if (!facts_of(choice).may_be_rescaled) return "";
  return compare(runs.here, runs.rescaled, runs.rescaled_telling, tolerance_of(choice, runs));
}

std::string check_bystander(const SceneChoice& choice, const SceneRuns& runs) {
  if (!facts_of(choice).may_have_bystander || !runs.here.refusal.empty()) return "";
  const GeneratedRun& run = runs.with_bystander;
  if (!run.refusal.empty()) return "it is refused with a bystander: " + run.refusal;
  return run.state == runs.here.state ? "" : "a body far away, and its effects, change bits";
}

std::string check_mirrored(const SceneChoice& choice, const SceneRuns& runs) {
  if (!was_run(runs.read)) return "";
  return compare(runs.read, runs.mirrored, runs.mirrored_telling, tolerance_of(choice, runs));
}

std::string check_step_to_zero(const SceneChoice&, const SceneRuns& runs) {
  if (runs.resolved.size() < 3) return "";
  double reach = 0.0;
  for (const GeneratedRun& run : runs.resolved) {
    if (!run.refusal.empty()) return "";
    reach = std::max(reach, run.reach);
  }
  const auto between = [&](std::size_t a, std::size_t b) {
    return (runs.resolved[a].points - runs.resolved[b].points).colwise().norm().maxCoeff();
  };
  const double longer = between(0, 1), shorter = between(1, 2);
  if (shorter <= kOfLonger * longer + kRounded * reach) return "";
  return fmt::format("half the time step changes the end by {:.3g} m, a quarter of it by {:.3g} m",
                     longer, shorter);
}

/// How far `run` is from `exact`, root mean square over the masses, as a share of how far that
/// came, or of a hundredth of the body's size.
double true_error(const GeneratedRun& run, const GeneratedRun& exact) {
  const Eigen::VectorXd& w = exact.weight;
  const auto mean = [&](const Positions& offsets) {
    return std::sqrt(offsets.colwise().squaredNorm().dot(w) / w.sum());
  };
  const Eigen::Vector3d center = exact.start * w / w.sum();
  const double size = mean(exact.start.colwise() - center);
  return mean(run.points - exact.points) /
         std::max(mean(exact.points - exact.start), kLeastTravel * size);
}

std::string check_told_error(const SceneChoice&, const SceneRuns& runs) {
  const GeneratedRun &here = runs.here, &exact = runs.converged;
  if (!was_run(exact) || !here.refusal.empty() || !here.error) return "";
  if (!exact.refusal.empty() || exact.is_unsure) return "";
  if (!runs.converged_otherwise.refusal.empty()) return "";
  // A scene with more than one answer, as of a sheet that buckles.
  if (true_error(runs.converged_otherwise, exact) > kDisagreement) return "";
  const double error = true_error(here, exact);
  if (here.is_inaccurate && error < kNeedless) {
    return fmt::format("{:.2g} % off, and it is warned of {:.2g} %", 100 * error,
                       100 * *here.error);
  }
  if (here.is_unsure || error <= kUntold) return "";
  return fmt::format("{:.2g} % off, and nothing warns: {:.2g} % are told", 100 * error,
                     100 * *here.error);
}

struct Oracle {
  std::string name;
  std::string (*check)(const SceneChoice&, const SceneRuns&);
};

const std::vector<Oracle>& oracles() {
  static const std::vector<Oracle> all = {{"finite", check_finite},
                                          {"reason", check_reason},
                                          {"time", check_time},
                                          {"same_bytes", check_bytes},
                                          {"rest", check_rest},
                                          {"momentum", check_momentum},
                                          {"energy", check_energy},
                                          {"passing", check_passing},
                                          {"turned", check_turned},
                                          {"rescaled", check_rescaled},
                                          {"bystander", check_bystander},
                                          {"mirrored", check_mirrored},
                                          {"step_to_zero", check_step_to_zero},
                                          {"told_error", check_told_error}};
  return all;
}

}  // namespace

std::string_view to_string(SceneFate fate) {
  constexpr std::string_view names[] = {"stable", "recovered", "refused", "failed"};
  return names[static_cast<int>(fate)];
}

const std::vector<std::string>& oracle_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Oracle& oracle : oracles()) all.push_back(oracle.name);
    all.push_back("threw");
    all.push_back("died");
    return all;
  }();
  return names;
}

SceneOutcome judge(const SceneChoice& choice, const SceneRuns& runs) {
  SceneOutcome outcome;
  const GeneratedRun& here = runs.here;
  outcome.seconds = here.seconds / std::max(1, here.steps);
  const SceneFacts facts = facts_of(choice);
  if (here.is_built && !facts.is_pushed && !facts.begins_beyond_limit) {
    outcome.energy = here.energy_gained / energy_scale(facts, here);
  }
  for (const Oracle& oracle : oracles()) {
    outcome.message = oracle.check(choice, runs);
    if (outcome.message.empty()) continue;
    outcome.fate = SceneFate::kFailed;
    outcome.oracle = oracle.name;
    return outcome;
  }
  outcome.message = here.refusal;
  outcome.fate = !here.refusal.empty() ? SceneFate::kRefused
                 : here.is_warned      ? SceneFate::kRecovered
                                       : SceneFate::kStable;
  return outcome;
}

SceneOutcome try_scene(const SceneChoice& choice, const std::string& robot, SceneCare care) {
  try {
    return judge(choice, run_all(choice, robot, care));
  } catch (const std::exception& error) {
    return {SceneFate::kFailed, "threw", error.what(), 0.0, 0.0};
  }
}

}  // namespace pliant
