#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/study/generated/generated_run.h"

namespace pliant {

/// How a scene fared.
enum class SceneFate { kStable, kRecovered, kRefused, kFailed };
std::string_view to_string(SceneFate fate);

struct SceneOutcome {
  SceneFate fate = SceneFate::kStable;
  std::string oracle;    ///< of a scene that failed: which one of oracle_names()
  std::string message;   ///< what it says; of a refused scene the reason
  double energy = 0.0;   ///< the most that was gained, over what there was and what falls here
  double seconds = 0.0;  ///< of the processor, for a step
};

/// The same scene told in several ways.
struct SceneRuns {
  GeneratedRun here;
  std::vector<GeneratedRun> again;                        ///< once more, and on 2 and on 4 threads
  GeneratedRun turned, nudged, rescaled, with_bystander;  ///< not built, refused with "": not run
  SceneTelling turned_telling, rescaled_telling;
  /// With the mesh from a file, and in the mirror.
  GeneratedRun read, mirrored;
  SceneTelling mirrored_telling;
  /// The same time by steps that resolve all, by twice and by four times as many.
  std::vector<GeneratedRun> resolved;
  /// To the end by Newton's method, and, nudged, by another one.
  GeneratedRun converged, converged_otherwise;
};

/// How closely a scene is looked at: kThorough adds the mirror, shorter steps and converged ones,
/// which take about as long as all else.
enum class SceneCare { kUsual, kThorough };

/// Of a nudge, over the bodies' size: far above round-off, far below all that matters.
inline constexpr double kNudge = 1e-10;
/// Most seconds of the processor for one telling of a scene.
inline constexpr double kSceneSeconds = 20.0;

SceneRuns run_all(const SceneChoice& choice, const std::string& robot,
                  SceneCare care = SceneCare::kUsual);
/// What the runs of a scene say.
SceneOutcome judge(const SceneChoice& choice, const SceneRuns& runs);
/// run_all() and judge(); what is thrown is a failure too.
SceneOutcome try_scene(const SceneChoice& choice, const std::string& robot,
                       SceneCare care = SceneCare::kUsual);

const std::vector<std::string>& oracle_names();

/// The simplest scene for which `fails` still holds: each factor of one for which it holds is set
/// to its first value, as long as that leaves it so.
using SceneTest = std::function<bool(const SceneChoice&)>;
SceneChoice shrink(const SceneChoice& choice, const SceneTest& fails);

}  // namespace pliant
