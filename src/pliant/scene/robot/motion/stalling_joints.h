#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/scene/robot/motion/joint_loads.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// Joints that stall where bodies press on their links as hard as their motors can, or leave them
/// no room: they stay behind the positions that they are told, with their effort, until these turn
/// back or the bodies give way. A joint is moved by positions, so that its inertia is left out.
class StallingJoints {
 public:
  explicit StallingJoints(const Robot& robot);

  /// Whether any joint has an effort that it can reach.
  bool any() const { return !limited_.empty(); }
  /// Where joints that were told to go to `told` go in a step of `duration` [s], from `positions`.
  void advance(const std::vector<double>& told, double duration, std::vector<double>& positions);
  /// After that step: whether a joint has to go back, in `positions`, and the step to be taken
  /// again. Never after the `last` try.
  bool answer(const std::vector<JointLoad>& loads, bool last, std::vector<double>& positions);
  /// After a step that failed: whether any joint can stay where it was, in `positions`.
  bool hold_back(std::vector<double>& positions);
  /// A run begins anew.
  void reset();
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);
  /// Says of each joint once that it stalled, and why.
  void note_first(std::vector<std::string>& notes);
  /// Says of each joint that stays behind what it is told now that it does, and why.
  void note_present(std::vector<std::string>& notes) const;

 private:
  struct Try {
    double position = 0.0, force = 0.0;
  };
  struct Joint {
    int index = 0;
    double effort = 0.0;    // [N] or [N m]
    double velocity = 0.0;  // that it catches up with at the most [m/s] or [rad/s]
    double told = 0.0;
    bool lags = false;               // behind what it was told
    double speed = 0.0;              // that it catches up with [m/s] or [rad/s]
    double stiffness = 0.0;          // of what presses: load over position; 0: unknown
    JointLoad load;                  // of the last step that was taken
    std::optional<double> pressing;  // where it last pressed on anything
    double start = 0.0;              // position at the running step's beginning
    Try tried;                       // where it was last, and what pressed there
    bool is_tried = false;           // in the running step
    std::optional<Try> over;         // of the running step: where too much presses
    std::optional<Try> under;        // and where less does
    double probe = 0.0;              // how far it goes back where nothing is known
    bool pressed = false;            // at the running step's beginning
    double after = 0.0;              // how far it went further last, after what slipped away
    bool is_noted = false;
  };
  static Joint fresh(const Joint& joint);
  std::string note(const Joint& joint) const;
  /// With what a joint sets out that stood still [m/s] or [rad/s].
  static double slowest(const Joint& joint, double duration);
  static double step(const Joint& joint, double duration);
  /// Whether it let go of what it pressed on, though it was told to stay: a body that moves between
  /// links presses more for a moment, and then not at all.
  static bool has_lost(const Joint& joint);
  static double return_to_body(const Joint& joint, double duration);
  /// How stiff what presses is, from the last try to this one.
  static void learn(Joint& joint, const Try& to);
  /// Whether nothing presses any more on a joint that stalled: a body between links rings when
  /// these set out, and falls while they wait for it.
  static bool has_slipped_away(const Joint& joint, const Try& tried);
  /// Where a joint looks for it in the same step.
  static double go_after(Joint& joint, const Try& tried, double duration);
  /// Whether a step to where a joint was tried has to be taken again, to `position`.
  bool go_back(Joint& joint, const JointLoad& load, double& position) const;
  static bool find_place(Joint& joint, const Try& tried, double& position);

  const Robot& robot_;
  double duration_ = 0.0;  // of the running step [s]
  std::vector<Joint> limited_;
};

}  // namespace pliant
