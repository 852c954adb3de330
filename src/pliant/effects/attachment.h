#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/body/region.h"
#include "pliant/core/effect.h"
#include "pliant/elements/attachment_set.h"

namespace pliant {

/// What is to be held, to what, how firmly and when.
struct AttachmentRequest {
  std::string name;
  Region region;         ///< of those of the body's particles that follow, when it begins
  int first = 0;         ///< particle
  int count = 0;         ///< of particles
  int obstacle = -1;     ///< that holds them; -1: the world does
  double stiffness = 0;  ///< of all together, shared in proportion to mass [N/m]
  double from = 0.0;     ///< simulated time [s]
  double until = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Holds some of a body's vertices to the world, an obstacle or a robot link, by springs from where
/// they are when it begins. Fixed vertices are left out. A body that nothing holds has no such
/// effect.
class AttachmentEffect final : public Effect {
 public:
  AttachmentEffect(Body& body, const std::vector<Obstacle>& obstacles)
      : body_(body), obstacles_(obstacles) {}
  std::string_view name() const override { return "attachment"; }
  void change_elements(Body& body, double dt) override;
  void before_step(Body& body, double dt) override;
  /// Until one begins or ends. What holds stands still, since nothing drives obstacles.
  bool join_resident_run(ResidentRun& run) const override;
  void add_reactions(std::vector<Reaction>& reactions) const override;
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  /// Of a scene: each reset brings it back. All three throw InputError, and then nothing changed:
  /// a name that is taken or unknown, a stiffness or a time out of range, a body that cannot be
  /// held; now or with `from` = 0, also where no vertex that may move is in the region.
  void add(const AttachmentRequest& request);
  /// Of a user: begins now and ends with the next reset; `dt` is the world's time step [s]. Returns
  /// the number of vertices.
  int attach_now(AttachmentRequest request, double dt);
  void detach(const std::string& name, double dt);

  /// Where the vertices are that it holds at present.
  void add_held(std::vector<Eigen::Vector3d>& points) const;
  /// Where a body is held: amid the points that its vertices are drawn to, in the axes of what
  /// holds them.
  struct Anchor {
    std::string name;
    Eigen::Isometry3d pose;  ///< world from anchor, at the end of the last step
  };
  /// Of those that hold at present.
  void add_anchors(std::vector<Anchor>& anchors) const;
  std::vector<std::string> names() const;  ///< of those that hold, or will
  bool has(const std::string& name) const;

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<AttachmentEffect>(this, type);
  }

 private:
  enum class Phase { kWaiting, kHolding, kOver };
  static constexpr int kPhases = 3;
  struct Entry {
    AttachmentRequest request;
    bool is_user = false;
    Phase phase = Phase::kWaiting;
    AttachmentSet* set = nullptr;  // the system's
  };
  void check(const AttachmentRequest& request) const;
  std::vector<int> pick(const AttachmentRequest& request) const;
  void begin(Entry& entry, const Eigen::Isometry3d& pose);
  Eigen::Isometry3d pose_start(const Entry& entry) const;
  Eigen::Isometry3d pose_end(const Entry& entry) const;
  AttachmentSet& new_set();

  Body& body_;
  const std::vector<Obstacle>& obstacles_;
  std::vector<Entry> entries_;  // those of the scene first
  std::vector<AttachmentSet*> spare_;
  bool is_loaded_ = false;  // and the solver does not know yet
};

/// Those of `count` particles of a body from `first` on that are in a region; of a body whose
/// surface alone can be gripped, as a rigid one, all of them where a point of that is.
std::vector<int> particles_to_hold(const Body& body, const Region& region, int first, int count);

/// Those of them that may move, each once, in order.
std::vector<int> free_particles_to_hold(const Body& body, const Region& region, int first,
                                        int count);

/// One more set among the body's elements, empty. Throws InputError for a model whose bodies cannot
/// be held.
AttachmentSet& new_attachment_set(Body& body);

/// Tells the body's solver that what is held changed; `dt`: of a step without substeps [s].
void prepare_again(Body& body, double dt);

/// The body's own; null where it has none yet.
AttachmentEffect* find_attachments(Body& body);
const AttachmentEffect* find_attachments(const Body& body);

/// The body's own, made where it has none.
AttachmentEffect& attachments_of(Body& body, const std::vector<Obstacle>& obstacles);

/// The first obstacle that is `name` or belongs to the robot link `name`; -1 for "world". Throws
/// InputError with the names that there are.
int find_holder(const std::string& name, const std::vector<Obstacle>& obstacles);

}  // namespace pliant
