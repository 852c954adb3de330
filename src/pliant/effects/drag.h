#pragma once

#include <vector>

#include "pliant/core/body/region.h"
#include "pliant/core/effect.h"
#include "pliant/elements/attachment_set.h"

namespace pliant {

/// The spring between a hand and what it has grabbed.
struct DragSpring {
  /// Of the whole region [N/m]; 0: as stiff as lets the grabbed body swing with 5 Hz, so that its
  /// own weight stretches the spring by 1 cm.
  double stiffness = 0.0;
  /// The force never is greater [N]; 0: what would accelerate the grabbed body by 50 m/s². With the
  /// damper it also limits the speed, to 0.8 m/s for a spring that nobody chose.
  double force_limit = 0.0;
};

/// Drags some of a body's vertices to a point that a user moves: a critically damped spring between
/// that point and the vertices' mass centre. They keep the places to each other that they had when
/// they were grabbed, as in a hand. Spring and damper are implicit and together never stiffer than
/// m/h², of the piece that is held, which leaves at rest 2 g h² of sag: so they are stable whatever
/// the stiffness. Where an explicit solver moves the body, m is the mass of the vertices, halved. A
/// body that nobody dragged has no such effect; reset() lets go.
class DragEffect final : public Effect {
 public:
  explicit DragEffect(Body& body) : body_(body) {}
  std::string_view name() const override { return "drag"; }
  void before_step(Body& body, double dt) override;
  bool join_resident_run(ResidentRun& /*run*/) const override {
    return !is_holding() && !is_loaded_;
  }
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  /// Grabs the vertices of a region that may move, in place of what it held before; they are to
  /// stay where they are until move_to(). `dt`: the world's time step [s]. Returns their number.
  /// Throws InputError, and then nothing changed: there are none, the stiffness or the limit is
  /// negative or not finite, or the model's bodies cannot be held.
  int grab(const Region& region, const DragSpring& spring, double dt);
  /// Where the mass centre of what it holds is to be [m]. Throws InputError for a point that is not
  /// finite.
  void move_to(const Eigen::Vector3d& point);
  void let_go(double dt);

  bool is_holding() const { return set_ != nullptr && set_->size() > 0; }
  /// The mass centre of what it holds [m].
  Eigen::Vector3d center() const;
  const Eigen::Vector3d& target() const { return target_; }  ///< [m]
  /// Of the spring alone, as far as the step bears it [N/m].
  double stiffness() const { return stiffness_; }
  double force_limit() const { return force_limit_; }  ///< [N]
  /// On the body in the last step [N].
  Eigen::Vector3d force() const;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<DragEffect>(this, type); }

 private:
  void choose(const std::vector<int>& held, const DragSpring& spring);
  void hold(const std::vector<int>& held, double dt);
  bool is_implicit() const;
  double largest_firmness(double h) const;

  Body& body_;
  AttachmentSet* set_ = nullptr;  // the system's; null before the first grab
  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
  double stiffness_ = 0.0, force_limit_ = 0.0;
  double damping_ = 0.0;      // [N s/m]
  double mass_ = 0.0;         // of the piece that it holds [kg]
  double held_mass_ = 0.0;    // of the vertices that it holds [kg]
  double firmness_ = 0.0;     // of the springs that stand for spring and damper [N/m]
  bool was_implicit_ = true;  // the solver for which that was chosen
  bool is_loaded_ = false;    // and the solver does not know yet
};

/// The body's own, made where it has none.
DragEffect& drag_of(Body& body);

/// The vertices of a body to grab at a point of its surface: those within `radius` [m], or the one
/// nearest to it that may move where there is none. Throws InputError where no vertex may move.
Region region_to_grab(const Body& body, const Eigen::Vector3d& point, double radius);

}  // namespace pliant
