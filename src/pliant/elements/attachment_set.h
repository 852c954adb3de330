#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/element_visitor.h"

namespace pliant {

/// Particles held to points of a frame, E = 1/2 Σ k |x_i - a_i|² with a_i = pose · point: the frame
/// is the world while its pose is the identity, a gripper or link when the pose follows that. A set
/// has one frame. Order and handles do not depend on what was removed. What it holds is part of no
/// checkpoint of the system, since attachments come and go: their effect keeps it.
class AttachmentSet final : public ElementSet {
 public:
  struct Attachment {
    int handle;
    int particle;
    Eigen::Vector3d point;  ///< in the frame [m]
    double stiffness;       ///< [N/m]
  };

  explicit AttachmentSet(int particles) : particles_(particles) {}

  std::string_view name() const override { return "attachment"; }
  int size() const override { return static_cast<int>(attachments_.size()); }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void add_held(std::vector<HeldVertex>& held) const override {
    for (const Attachment& a : attachments_) held.push_back({a.particle, a.stiffness});
  }
  bool is_moving() const override { return start_.matrix() != pose_.matrix(); }
  void reset_multipliers() override { multipliers_.setZero(); }
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  /// Holds `particle` to `point` of the frame [m] with `stiffness` > 0 [N/m]; returns a handle that
  /// no other attachment of this set has had. Solvers that keep the system matrix have to be
  /// prepared again. Throws InputError for a particle out of range or attached already, a point
  /// that is not finite, or a stiffness that is not positive and finite.
  int add(int particle, const Eigen::Vector3d& point, double stiffness);
  /// Lets go without a trace; the rest as with add(). Throws InputError for an unknown handle.
  void remove(int handle);
  void clear();
  /// Moves one point of the frame [m]. Throws InputError for an unknown handle or a point that is
  /// not finite.
  void set_target(int handle, const Eigen::Vector3d& point);
  /// Puts the frame somewhere, and with it every point. Throws InputError for a pose that is not
  /// finite.
  void set_frame(const Eigen::Isometry3d& pose) { move_frame(pose, pose); }
  /// Moves it during a step. Forces and energies are those at its end. Throws as set_frame().
  void move_frame(const Eigen::Isometry3d& start, const Eigen::Isometry3d& end);
  /// All attachments and the frame, and back. Throws InputError for what cannot be attached.
  void write(StateArchive& numbers) const;
  void read(StateArchive& numbers);

  /// The net force on the particles in a step is not to be above it [N, > 0], for systems that find
  /// the force of a whole step (HoldsAttachments): they move the frame nearer to the particles.
  void limit_force(double limit) { force_limit_ = limit; }
  double force_limit() const { return force_limit_; }
  /// The net force on the particles in the last step [N], told by such systems of a set with a
  /// limit.
  const Eigen::Vector3d& told_force() const { return told_force_; }
  void tell_force(const Eigen::Vector3d& force) { told_force_ = force; }

  const Eigen::Isometry3d& frame() const { return pose_; }
  const Eigen::Isometry3d& frame_start() const { return start_; }
  /// Another one whenever particles or stiffnesses changed.
  long version() const { return version_; }
  /// In the order in which they were added.
  const std::vector<Attachment>& attachments() const { return attachments_; }
  /// Where the attachment's point is in world [m].
  Eigen::Vector3d target(const Attachment& attachment) const { return pose_ * attachment.point; }
  /// The force that the particles exert on the frame, then the torque about its origin, in world
  /// axes [N, N m].
  Eigen::Matrix<double, 6, 1> wrench(const Positions& x) const;

 private:
  std::vector<Attachment>::iterator find(int handle);
  Eigen::Vector3d force(const Attachment& attachment, const Positions& x) const {
    return attachment.stiffness * (target(attachment) - x.col(attachment.particle));
  }

  int particles_;
  int next_handle_ = 0;
  long version_ = 0;
  Eigen::Isometry3d start_ = Eigen::Isometry3d::Identity();  // world from frame
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();   // at the step's end
  std::vector<Attachment> attachments_;
  Eigen::Matrix3Xd multipliers_;  // 3 x attachments [N]
  double force_limit_ = std::numeric_limits<double>::infinity();
  Eigen::Vector3d told_force_ = Eigen::Vector3d::Zero();
};

/// A system that is not made of element sets, and that attachments can hold.
class HoldsAttachments {
 public:
  virtual ~HoldsAttachments() = default;
  virtual void add_attachments(std::unique_ptr<AttachmentSet> set) = 0;
};

}  // namespace pliant
