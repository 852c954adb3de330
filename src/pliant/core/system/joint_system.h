#pragma once

#include <memory>
#include <vector>

#include "pliant/core/system/system.h"

namespace pliant {

/// The systems of several bodies as one, for a solver that moves these together. Particles, element
/// sets and constraints stay the bodies' own and keep their numbers there: here they lie side by
/// side, body after body. take() and give() carry the motion over.
class JointSystem final : public ProjectiveSystem {
 public:
  /// Members that follow coordinates have particles alone here: to all but corrections, which ask
  /// how they answer, these are pinned, and others move them.
  enum class Responders { kPinned, kAnswer };

  /// `members` outlive this. Of those that are `bare`, one flag a member where there are any, the
  /// particles alone are seen, as free masses.
  explicit JointSystem(const std::vector<System*>& members, std::vector<bool> bare = {},
                       Responders responders = Responders::kPinned);
  ~JointSystem() override;

  /// The number of a member's first particle here.
  int first(int member) const;
  int count(int member) const;
  /// Element sets and constraints of a member here.
  std::vector<ElementSet*> elements_of(int member) const;
  std::vector<Constraint*> constraints_of(int member) const;
  /// Conditions between members.
  const std::vector<Constraint*>& between() const { return between_; }
  /// Adds a condition between members, which outlives this. It sees the particles of all.
  void add_constraint(Constraint* constraint);
  /// Masses, pinned particles, element sets or constraints of members changed.
  void rebuild();
  /// Motion and external forces of the members' particles.
  void take();
  /// The motion back to the members, and the forces between them.
  void give();
  void undo_step() override;
  void keep_rigid(Positions& x) const override;
  bool flows() const override;

 private:
  class Member;
  class Elements;
  class MemberConstraint;

  void list_members(Member& member);
  bool is_bare(std::size_t member) const;
  /// All members have the same integration.
  void take_inertia();
  void add_responder(Member& member);

  std::vector<bool> bare_;
  Responders how_responders_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<std::size_t> element_ends_, constraint_ends_;     // of members
  std::vector<std::unique_ptr<MemberConstraint>> constraints_;  // of members
  std::vector<Constraint*> between_;                            // members
  Forces forces_;                                               // between members
  Positions first_;                                             // where a reset puts the particles
};

}  // namespace pliant
