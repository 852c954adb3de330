#include "pliant/solvers/components/components.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {
namespace {

// Of a row's diagonal: what its entries add up to beyond that holds the particle from outside.
constexpr double kOuterShare = 1e-9;

/// Joins particles that an entry of the matrix ties (union by the smaller number, so that the
/// result does not depend on the order of the entries).
class Ties final : public SystemMatrix {
 public:
  explicit Ties(const Particles& particles)
      : particles_(particles),
        parents_(static_cast<std::size_t>(particles.size())),
        pinned_(static_cast<std::size_t>(particles.size()), false),
        sums_(Eigen::VectorXd::Zero(particles.size())),
        diagonal_(Eigen::VectorXd::Zero(particles.size())) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  void add(int row, int column, double stiffness) override {
    if (stiffness == 0.0) return;
    sums_[row] += stiffness;
    if (row == column) {
      diagonal_[row] += stiffness;
      return;
    }
    const bool row_is_fixed = particles_.is_fixed(row), other = particles_.is_fixed(column);
    if (row_is_fixed && other) return;
    if (row_is_fixed || other) {
      pinned_[static_cast<std::size_t>(row_is_fixed ? column : row)] = true;
      return;
    }
    join(row, column);
  }

  void add_shared(const SharedEntries& shared) override {
    // All are tied to one, and rows add up to nothing.
    const auto pulls = [&](const auto& m) { return shared.stiffness * m.mass != 0.0; };
    const bool any_fixed =
        std::any_of(shared.members.begin(), shared.members.end(),
                    [&](const auto& m) { return pulls(m) && particles_.is_fixed(m.particle); });
    int first = -1;
    for (const SharedEntries::Member& member : shared.members) {
      const int i = member.particle;
      if (!pulls(member) || particles_.is_fixed(i)) continue;
      diagonal_[i] += shared.stiffness * member.mass;
      if (any_fixed) pinned_[static_cast<std::size_t>(i)] = true;
      if (first < 0) first = i;
      join(first, i);
    }
  }

  int root(int i) {
    while (parents_[static_cast<std::size_t>(i)] != i) {
      int& parent = parents_[static_cast<std::size_t>(i)];
      parent = parents_[static_cast<std::size_t>(parent)];
      i = parent;
    }
    return i;
  }
  bool is_pinned(int i) const { return pinned_[static_cast<std::size_t>(i)]; }
  /// Whether entries hold particle `i` from outside, as an attachment does.
  bool is_held_outside(int i) const { return sums_[i] > kOuterShare * diagonal_[i]; }

 private:
  void join(int i, int j) {
    const int a = root(i), b = root(j);
    if (a != b) parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

  const Particles& particles_;
  std::vector<int> parents_;
  std::vector<bool> pinned_;
  Eigen::VectorXd sums_, diagonal_;  // of the rows
};

/// Marks the components of all particles that an entry stands for.
class Marks final : public SystemMatrix {
 public:
  Marks(const std::vector<int>& component_of, std::vector<bool>& marks)
      : component_of_(component_of), marks_(marks) {}
  void add(int row, int, double) override {
    const int component = component_of_[static_cast<std::size_t>(row)];
    if (component != Components::kNone) marks_[static_cast<std::size_t>(component)] = true;
  }
  void add_shared(const SharedEntries& shared) override {
    for (const SharedEntries::Member& member : shared.members) add(member.particle, 0, 0.0);
  }

 private:
  const std::vector<int>& component_of_;
  std::vector<bool>& marks_;
};

void find_twisted(const ProjectiveSystem& system, Components& components) {
  components.twisted.assign(components.held.size(), false);
  Marks marks(components.of, components.twisted);
  for (const auto& set : system.elements) {
    if (set->has_torque()) set->add_to_system(marks);
  }
}

}  // namespace

Components find_components(const ProjectiveSystem& system) {
  const Particles& particles = system.particles;
  const auto n = static_cast<std::size_t>(particles.size());
  Components result;
  Ties ties(particles);
  for (const auto& set : system.elements) set->add_to_system(ties);
  // The smallest particle of a component is its root, so that components come in that order.
  result.of.assign(n, Components::kNone);
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    const int root = ties.root(i);
    auto& of = result.of[static_cast<std::size_t>(i)];
    if (root == i) {
      of = result.count();
      result.held.push_back(false);
    } else {
      of = result.of[static_cast<std::size_t>(root)];
    }
    if (ties.is_pinned(i) || ties.is_held_outside(i))
      result.held[static_cast<std::size_t>(of)] = true;
  }
  for (const auto& [begin, end] : system.moved_by_others) {
    for (int i = begin; i < end; ++i) {
      const int of = result.of[static_cast<std::size_t>(i)];
      if (of != Components::kNone) result.held[static_cast<std::size_t>(of)] = true;
    }
  }
  find_twisted(system, result);
  result.begins.assign(result.held.size() + 1, 0);
  for (const int of : result.of) {
    if (of != Components::kNone) ++result.begins[static_cast<std::size_t>(of) + 1];
  }
  std::partial_sum(result.begins.begin(), result.begins.end(), result.begins.begin());
  result.members.resize(static_cast<std::size_t>(result.begins.back()));
  std::vector<int> next(result.begins.begin(), result.begins.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (result.of[i] == Components::kNone) continue;
    auto& at = next[static_cast<std::size_t>(result.of[i])];
    result.members[static_cast<std::size_t>(at++)] = static_cast<int>(i);
  }
  return result;
}

}  // namespace pliant
