#include "pliant/core/system/joint_system.h"

#include <algorithm>
#include <utility>

namespace pliant {

/// Some particles of the joint system, those of one body. What looks at the body's system while the
/// joint one is solved sees there what it is handed.
class JointSystem::Member {
 public:
  Member(System& own, int first) : system(own), first_(first) {}

  int first() const { return first_; }
  int count() const { return system.particles.size(); }
  template <class Matrix>
  auto columns(Matrix& all) const {
    return all.middleCols(first_, count());
  }
  template <class Vector>
  auto part(Vector& all) const {
    return all.segment(first_, count());
  }

  /// The member's own numbers of positions of all.
  Positions& positions(const Positions& all) {
    system.particles.x = columns(all);
    return system.particles.x;
  }
  const Eigen::VectorXd& numbers(const Eigen::VectorXd& all) {
    numbers_ = part(all);
    return numbers_;
  }
  /// Calls `add` with the member's part of `f`, to which it adds.
  template <class Add>
  void add_to(Forces& f, const Add& add) {
    forces_ = columns(f);
    add(forces_);
    columns(f) = forces_;
  }
  void take(Particles& all) const {
    const Particles& own = system.particles;
    columns(all.x) = own.x;
    columns(all.v) = own.v;
    columns(all.x_start) = own.x_start;
    columns(all.v_start) = own.v_start;
    columns(all.v_before) = own.v_before;
    if (!own.inertia.is_used) return;
    columns(all.inertia.x) = own.inertia.x;
    columns(all.inertia.v) = own.inertia.v;
  }
  void give(const Particles& all) const {
    Particles& own = system.particles;
    own.x = columns(all.x);
    own.v = columns(all.v);
    own.x_start = columns(all.x_start);
    own.v_start = columns(all.v_start);
    own.v_before = columns(all.v_before);
  }

  System& system;

 private:
  int first_;
  Eigen::VectorXd numbers_;
  Forces forces_;
};

/// An element set of a member. That keeps, saves and forgets what it learned by itself.
class JointSystem::Elements final : public ElementSet {
 public:
  Elements(Member& member, ElementSet& own) : member_(member), own_(own) {}

  std::string_view name() const override { return own_.name(); }
  int size() const override { return own_.size(); }
  double energy(const Positions& x) const override { return own_.energy(member_.positions(x)); }
  void add_forces(const Positions& x, Forces& f) const override {
    member_.add_to(f, [&](Forces& part) { own_.add_forces(member_.positions(x), part); });
  }
  void add_to_system(SystemMatrix& a) const override {
    MovedEntries moved(a, member_.first());
    own_.add_to_system(moved);
  }
  double work() const override { return own_.work(); }
  Cost cost_of_element() const override { return own_.cost_of_element(); }
  bool is_solid() const override { return own_.is_solid(); }
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override {
    MovedBlocks moved(k, member_.first());
    own_.add_stiffness(member_.positions(x), definiteness, moved);
  }
  bool has_torque() const override { return own_.has_torque(); }
  bool is_viscous() const override { return own_.is_viscous(); }
  void prepare(double step) override { own_.prepare(step); }
  void begin_step(const Particles& particles) override {
    member_.give(particles);
    own_.begin_step(member_.system.particles);
  }
  void reset_multipliers() override { own_.reset_multipliers(); }
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override {
    Positions& part = member_.positions(x);
    own_.relax(member_.numbers(inverse_mass), dt, part);
    member_.columns(x) = part;
  }

 private:
  /// A matrix whose rows and columns are the member's.
  class MovedEntries final : public SystemMatrix {
   public:
    MovedEntries(SystemMatrix& all, int first) : all_(all), first_(first) {}
    void add(int row, int column, double stiffness) override {
      all_.add(first_ + row, first_ + column, stiffness);
    }
    void add_shared(const SharedEntries& shared) override {
      SharedEntries moved = shared;
      for (SharedEntries::Member& member : moved.members) member.particle += first_;
      all_.add_shared(moved);
    }

   private:
    SystemMatrix& all_;
    int first_;
  };
  class MovedBlocks final : public StiffnessMatrix {
   public:
    MovedBlocks(StiffnessMatrix& all, int first) : all_(all), first_(first) {}
    void add(int row, int column, const Eigen::Matrix3d& block) override {
      all_.add(first_ + row, first_ + column, block);
    }
    void add_isotropic(int row, int column, double stiffness) override {
      all_.add_isotropic(first_ + row, first_ + column, stiffness);
    }
    void add_shared(const SharedStiffness& shared) override {
      shared_ = shared;
      for (SharedStiffness::Member& member : shared_.members) member.particle += first_;
      all_.add_shared(shared_);
    }

   private:
    StiffnessMatrix& all_;
    int first_;
    SharedStiffness shared_;  // kept for its memory
  };

  Member& member_;
  ElementSet& own_;
};

/// A constraint of a member alone.
class JointSystem::MemberConstraint final : public Constraint {
 public:
  MemberConstraint(Member& member, Constraint& own) : member_(member), own_(own) {}

  std::string_view name() const override { return own_.name(); }
  void begin_step(const Particles& particles, double dt) override {
    member_.give(particles);
    own_.begin_step(member_.system.particles, dt);
  }
  void reset_multipliers() override { own_.reset_multipliers(); }
  void relax(const Eigen::VectorXd& mobility, Positions& x) override {
    if (own_.is_idle()) return;
    Positions& part = member_.positions(x);
    own_.relax(member_.numbers(mobility), part);
    member_.columns(x) = part;
  }
  void add_forces(Forces& f) const override {
    if (own_.is_idle()) return;
    member_.add_to(f, [&](Forces& part) { own_.add_forces(part); });
  }
  void add_rows(const Positions& x, ConstraintRows& rows) override {
    const std::size_t entries = rows.entries();
    own_.add_rows(member_.positions(x), rows);
    rows.renumber(entries, member_.first());
  }
  bool takes_multipliers() const override { return own_.takes_multipliers(); }
  bool tells_point_constraints() const override { return own_.tells_point_constraints(); }
  void warm_start() override { own_.warm_start(); }
  void add_point_constraints(const Positions& x, PointConstraints& constraints) override {
    const std::size_t entries = constraints.entries.size(),
                      gradients = constraints.gradients.size();
    own_.add_point_constraints(member_.positions(x), constraints);
    constraints.renumber(entries, gradients, member_.first());
  }
  bool needs_matrix() const override { return own_.needs_matrix(); }
  void take_multipliers(const PointConstraints& constraints) override {
    own_.take_multipliers(constraints);
  }
  bool is_collective() const override { return own_.is_collective(); }
  double work(const Positions& x) const override { return own_.work(member_.positions(x)); }
  bool tells_energy() const override { return own_.tells_energy(); }
  bool is_idle() const override { return own_.is_idle(); }
  int active() const override { return own_.active(); }
  bool finds_more(const Positions& x, bool done) override {
    return own_.finds_more(member_.positions(x), done);
  }
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override {
    Positions& part = member_.positions(x);
    own_.final_projection(member_.numbers(mobility), part);
    member_.columns(x) = part;
  }
  bool needs_alternating_projection() const override { return own_.needs_alternating_projection(); }
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) override {
    Positions& part = member_.positions(x);
    const double missed = own_.alternating_projection(member_.numbers(mobility), part);
    member_.columns(x) = part;
    return missed;
  }
  bool limit_displacement(Positions& x) override {
    Positions& part = member_.positions(x);
    const bool is_free = own_.limit_displacement(part);
    member_.columns(x) = part;
    return is_free;
  }
  void report(StepReport& report) const override { own_.report(report); }

 private:
  Member& member_;
  Constraint& own_;
};

JointSystem::JointSystem(const std::vector<System*>& members, std::vector<bool> bare,
                         Responders responders)
    : bare_(std::move(bare)), how_responders_(responders) {
  int first = 0;
  for (System* system : members) {
    members_.push_back(std::make_unique<Member>(*system, first));
    first += system->particles.size();
  }
  rebuild();
}

JointSystem::~JointSystem() = default;

int JointSystem::first(int member) const {
  return members_[static_cast<std::size_t>(member)]->first();
}

int JointSystem::count(int member) const {
  return members_[static_cast<std::size_t>(member)]->count();
}

std::vector<ElementSet*> JointSystem::elements_of(int member) const {
  const auto m = static_cast<std::size_t>(member);
  std::vector<ElementSet*> own;
  for (std::size_t k = m == 0 ? 0 : element_ends_[m - 1]; k < element_ends_[m]; ++k) {
    own.push_back(elements[k].get());
  }
  return own;
}

std::vector<Constraint*> JointSystem::constraints_of(int member) const {
  const auto m = static_cast<std::size_t>(member);
  return {constraints.begin() + static_cast<std::ptrdiff_t>(m == 0 ? 0 : constraint_ends_[m - 1]),
          constraints.begin() + static_cast<std::ptrdiff_t>(constraint_ends_[m])};
}

void JointSystem::add_constraint(Constraint* constraint) {
  between_.push_back(constraint);
  constraints.push_back(constraint);
}

bool JointSystem::is_bare(std::size_t member) const {
  return (member < bare_.size() && bare_[member]) ||
         members_[member]->system.as_projective() == nullptr;
}

void JointSystem::add_responder(Member& member) {
  const int begin = member.first(), end = begin + member.count();
  if (RespondingSystem* system = member.system.as_responding()) {
    responders.push_back({begin, end, system});
  }
  if (how_responders_ == Responders::kPinned) {
    for (int i = begin; i < end; ++i) particles.fix(i);
  } else {
    moved_by_others.emplace_back(begin, end);
  }
}

void JointSystem::list_members(Member& member) {
  for (const auto& set : member.system.as_projective()->elements) {
    elements.push_back(std::make_unique<Elements>(member, *set));
  }
  for (Constraint* constraint : member.system.constraints) {
    constraints_.push_back(std::make_unique<MemberConstraint>(member, *constraint));
    constraints.push_back(constraints_.back().get());
  }
}

void JointSystem::rebuild() {
  elements.clear();
  constraints.clear();
  constraints_.clear();
  particles = Particles();
  first_.resize(3, 0);
  bool knows_first = true;
  element_ends_.clear();
  constraint_ends_.clear();
  moved_by_others.clear();
  responders.clear();
  for (std::size_t m = 0; m < members_.size(); ++m) {
    Member& member = *members_[m];
    System& own = member.system;
    particles.append(own.particles);
    if (own.as_projective() == nullptr) {
      add_responder(member);
    } else if (is_bare(m)) {
      moved_by_others.emplace_back(member.first(), member.first() + member.count());
    } else {
      list_members(member);
    }
    element_ends_.push_back(elements.size());
    constraint_ends_.push_back(constraints.size());
    knows_first = knows_first && own.first_positions != nullptr;
    if (!knows_first) continue;
    first_.conservativeResize(3, particles.size());
    first_.rightCols(own.particles.size()) = *own.first_positions;
  }
  constraints.insert(constraints.end(), between_.begin(), between_.end());
  external_forces.setZero(3, particles.size());
  first_positions = knows_first ? &first_ : nullptr;
}

void JointSystem::take_inertia() {
  const InertialStart& first = members_.front()->system.particles.inertia;
  InertialStart& own = particles.inertia;
  own.is_used = first.is_used;
  if (!own.is_used) return;
  own.share = first.share;
  own.step = first.step;
  own.whole = first.whole;
  own.x.resize(3, particles.size());
  own.v.resize(3, particles.size());
}

void JointSystem::take() {
  take_inertia();
  for (const auto& member : members_) {
    member->take(particles);
    member->columns(external_forces) = member->system.external_forces;
  }
}

void JointSystem::give() {
  forces_.setZero(3, particles.size());
  for (const Constraint* constraint : between_) constraint->add_forces(forces_);
  for (const auto& member : members_) {
    member->give(particles);
    member->system.forces_of_bodies = member->columns(forces_);
  }
}

bool JointSystem::flows() const {
  return std::any_of(members_.begin(), members_.end(), [](const auto& member) {
    const ProjectiveSystem* system = member->system.as_projective();
    return system != nullptr && system->flows();
  });
}

void JointSystem::keep_rigid(Positions& x) const {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (is_bare(m)) continue;
    Member& member = *members_[m];
    Positions& part = member.positions(x);
    member.system.as_projective()->keep_rigid(part);
    member.columns(x) = part;
  }
}

void JointSystem::undo_step() {
  for (const auto& member : members_) member->system.undo_step();
  for (const auto& member : members_) member->take(particles);
}

}  // namespace pliant
