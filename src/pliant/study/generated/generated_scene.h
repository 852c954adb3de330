#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "pliant/scene/scene.h"
#include "pliant/study/generated/generated_factors.h"

namespace pliant {

/// How a generated scene is told without becoming another one.
struct SceneTelling {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();  ///< of all of it [m]
  /// All lengths times this, masses times its cube, times as they are: then stresses grow with its
  /// square, and so on.
  double length = 1.0;
  /// A body far away, with all effects that the others have not.
  bool has_bystander = false;
  double nudge = 0.0;  ///< of where the first body begins, over its size, and of its angle [rad]
  /// File with the mesh of the first body, a cloth or a patch; "" where the scene makes it.
  std::string mesh;
  std::string solver;      ///< "name: newton, ..." in place of the scene's; "": that
  double time_step = 0.0;  ///< [s]; 0: the scene's
  int steps = 0;           ///< 0: the scene's

  /// `place` mirrors too; then so does `mesh`.
  bool is_mirrored() const { return place.linear().determinant() < 0.0; }
};

/// What holds for a scene, whoever tells it.
struct SceneFacts {
  double size = 0.1;       ///< of its first body, told with length 1 [m]
  double time_step = 0.0;  ///< [s]
  int steps = 0;
  bool has_gravity = false;
  bool has_obstacles = false;        ///< bodies may touch something
  bool is_held = false;              ///< some vertices are pinned, or held by springs
  bool is_pushed = false;            ///< something moves by itself, or brings energy
  bool is_quiet = false;             ///< nothing moves and nothing pulls: it stays at rest
  bool loses_momentum = false;       ///< to the air about it
  bool has_liquid = false;           ///< whose energy is no sum of its particles'
  bool begins_beyond_limit = false;  ///< of strain: it is taken back at once, which brings speed
  bool may_blow_up = false;          ///< a method that is known to, where it then says so
  bool may_have_bystander = true;
  bool may_be_rescaled = true;  ///< false: it has the size that it has
  bool may_be_mirrored = true;  ///< its mesh can be read from a file, and nothing else has sides
  /// Its motion is one of forces and inertia alone: shorter steps come nearer to it.
  bool is_smooth = true;
  bool has_reference = true;  ///< Newton's method solves the same steps
};

/// Gravity of generated scenes [m/s^2].
inline constexpr double kGeneratedGravity = 9.81;

SceneFacts facts_of(const SceneChoice& choice);
/// [m/s^2]
Eigen::Vector3d gravity_of(const SceneChoice& choice, const SceneTelling& telling);
/// A time step that resolves the fastest vibrations of the first body [s].
double resolved_time_step(const SceneChoice& choice);
/// Writes the mesh of the first body, a cloth or a patch, as it is or with y turned round. Throws
/// InputError.
void write_generated_mesh(const SceneChoice& choice, const std::string& robot, bool is_mirrored,
                          const std::string& path);
/// The scene as a file would say it; but for the start and the moving hand, which make() adds.
/// `robot` is the path of finger.urdf.
std::string scene_text(const SceneChoice& choice, const SceneTelling& telling,
                       const std::string& robot);
/// Throws InputError where the scene is refused.
LoadedScene make_generated(const SceneChoice& choice, const SceneTelling& telling,
                           const std::string& robot);

}  // namespace pliant
