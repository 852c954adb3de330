#include <stdlib.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "pliant/study/generated/generated_oracles.h"
#include "pliant/study/generated/generated_random.h"

namespace pliant {
namespace {

/// A folder that goes with it.
class ShortLivedFolder {
 public:
  ShortLivedFolder() {
    std::string name = std::filesystem::temp_directory_path() / "pliant-scene-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
      throw std::system_error(errno, std::generic_category(), "a folder for a mesh");
    }
    path_ = name;
  }
  ~ShortLivedFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ShortLivedFolder(const ShortLivedFolder&) = delete;
  ShortLivedFolder& operator=(const ShortLivedFolder&) = delete;
  std::string file(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

void run_mirrored(const SceneChoice& choice, const std::string& robot, SceneRuns& runs) {
  const ShortLivedFolder folder;
  const std::string extension = value_of(choice, kFactorModel) == "cloth" ? ".obj" : ".msh";
  SceneTelling read;
  read.mesh = folder.file("body" + extension);
  write_generated_mesh(choice, robot, false, read.mesh);
  runs.read = run_generated(choice, read, 1, robot);
  runs.mirrored_telling.mesh = folder.file("mirrored" + extension);
  write_generated_mesh(choice, robot, true, runs.mirrored_telling.mesh);
  const Eigen::Vector3d normal = Eigen::Vector3d(2, 1, -2) / 3.0;
  runs.mirrored_telling.place.linear() -= 2.0 * normal * normal.transpose();
  runs.mirrored = run_generated(choice, runs.mirrored_telling, 1, robot);
}

void run_resolved(const SceneChoice& choice, const std::string& robot, SceneRuns& runs) {
  constexpr int kSteps = 5;
  for (int parts = 1; parts <= 4; parts *= 2) {
    SceneTelling finer;
    finer.time_step = resolved_time_step(choice) / parts;
    finer.steps = kSteps * parts;
    runs.resolved.push_back(run_generated(choice, finer, 1, robot));
  }
}

void run_converged(const SceneChoice& choice, const std::string& robot, SceneRuns& runs) {
  SceneTelling converged, otherwise;
  converged.solver = "name: newton, iterations: 200, tolerance: 1e-8";
  runs.converged = run_generated(choice, converged, 1, robot);
  otherwise.solver = "name: lbfgs, iterations: 400, tolerance: 1e-8";
  otherwise.nudge = kNudge;
  runs.converged_otherwise = run_generated(choice, otherwise, 1, robot);
}

}  // namespace

SceneRuns run_all(const SceneChoice& choice, const std::string& robot, SceneCare care) {
  SceneRuns runs;
  runs.here = run_generated(choice, {}, 1, robot);
  if (runs.here.seconds > kSceneSeconds) return runs;
  for (const int threads : {2, 4}) {
    runs.again.push_back(run_generated(choice, {}, threads, robot));
  }
  const SceneFacts facts = facts_of(choice);
  runs.turned_telling.place.linear() = GeneratedRandom(17).rotation();
  runs.turned_telling.place.translation() = Eigen::Vector3d(0.3, -0.2, 0.5);
  runs.turned = run_generated(choice, runs.turned_telling, 1, robot);
  runs.rescaled_telling.length = 2.0;
  if (facts.may_be_rescaled) {
    runs.rescaled = run_generated(choice, runs.rescaled_telling, 1, robot);
  }
  if (!runs.here.refusal.empty()) return runs;
  SceneTelling nudged, with_bystander;
  nudged.nudge = kNudge;
  runs.nudged = run_generated(choice, nudged, 1, robot);
  with_bystander.has_bystander = true;
  if (facts.may_have_bystander) {
    runs.with_bystander = run_generated(choice, with_bystander, 1, robot);
  }
  if (care == SceneCare::kUsual) return runs;
  if (facts.may_be_mirrored) run_mirrored(choice, robot, runs);
  if (facts.is_smooth) run_resolved(choice, robot, runs);
  if (facts.has_reference) run_converged(choice, robot, runs);
  return runs;
}

}  // namespace pliant
