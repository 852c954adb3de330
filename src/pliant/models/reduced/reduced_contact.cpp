#include "pliant/models/reduced/reduced_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace pliant {
namespace {

// Softness of a contact over the largest response of all that touch.
constexpr double kSoftness = 1e-3;
// Sweeps over all contacts at the most, and the move, as a share of the offset, that ends them.
constexpr int kMaxSweeps = 100;
constexpr double kSmallMove = 1e-7;
// Times that points which the others' forces pushed into obstacles are taken in.
constexpr int kLateRounds = 2;

/// Largest eigenvalue of [[a, b], [b, c]].
double largest_eigenvalue(double a, double b, double c) {
  return 0.5 * (a + c) + std::hypot(0.5 * (a - c), b);
}

/// What force with a disc as its bound comes nearest to `wish`.
Eigen::Vector2d within(const Eigen::Vector2d& wish, double radius) {
  const double size = wish.norm();
  return size > radius ? Eigen::Vector2d(radius / size * wish) : wish;
}

template <class A, class B>
bool is_before(const A& a, const B& b) {
  return std::tie(a.obstacle, a.point) < std::tie(b.obstacle, b.point);
}

}  // namespace

ReducedContact::ReducedContact(const ReducedVertices& vertices, const EmbeddedPoints& points)
    : vertices_(vertices), points_(points) {
  guess_ = guess_start_ = moved_ = Eigen::VectorXd::Zero(vertices.rank());
}

void ReducedContact::reset() {
  touches_.clear();
  guess_.setZero();
}

void ReducedContact::begin_step() {
  touches_start_ = touches_;
  guess_start_ = guess_;
}

void ReducedContact::undo_step() {
  touches_.swap(touches_start_);
  guess_.swap(guess_start_);
}

Eigen::Vector3d ReducedContact::known_force(const Contact& contact) const {
  const auto found =
      std::lower_bound(touches_.begin(), touches_.end(), contact,
                       [](const Touch& a, const Contact& b) { return is_before(a, b); });
  if (found == touches_.end() || is_before(contact, *found)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d& along = found->friction_force;
  return found->normal_force * contact.normal + along - contact.normal * contact.normal.dot(along);
}

void ReducedContact::add_rows(std::size_t first, const Step& step, ReducedSystem& system) {
  const std::vector<Contact>& contacts = step.effect.contacts();
  const auto last = static_cast<Eigen::Index>(3 * contacts.size());
  if (gradients_.cols() < last) {
    gradients_.conservativeResize(vertices_.rank(), 2 * last);
    moves_.conservativeResize(vertices_.rank(), 2 * last);
  }
  rows_.resize(contacts.size());
  bounds_.resize(contacts.size());
  for (std::size_t c = first; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    Row& row = rows_[c];
    row.axes.col(0) = contact.normal;
    row.axes.col(1) = contact.normal.unitOrthogonal();
    row.axes.col(2) = contact.normal.cross(row.axes.col(1));
    auto gradient = gradients_.middleCols<3>(static_cast<Eigen::Index>(3 * c));
    auto move = moves_.middleCols<3>(static_cast<Eigen::Index>(3 * c));
    vertices_.rows_of(points_, contact.point, move);
    gradient.noalias() = move.lazyProduct(row.axes);
    step.response.to_q(gradient, move);
    row.target = row.axes.transpose() * contact.surface_motion;
    row.surface_speed = row.target / step.h;
    row.target[0] = contact.plane -
                    contact.normal.dot(points_.position(system.particles.x_start, contact.point));
    row.force = row.axes.transpose() * known_force(contact);
    row.known = row.force;
    row.impulse.setZero();
    const Eigen::Matrix3d own = gradient.transpose().lazyProduct(move);
    const Eigen::Matrix3d mass = gradient.transpose().lazyProduct(gradient);
    row.own = own(0, 0);
    row.own_tangent = largest_eigenvalue(own(1, 1), own(1, 2), own(2, 2));
    row.mass_own = mass(0, 0);
    row.mass_tangent = largest_eigenvalue(mass(1, 1), mass(1, 2), mass(2, 2));
    bounds_[c] = step.friction == nullptr ? 0.0 : step.friction->coefficient(contact);
    if (bounds_[c] == 0.0) row.force.tail<2>().setZero();
    softness_ = std::max(softness_, kSoftness * row.own);
    mass_softness_ = std::max(mass_softness_, kSoftness * row.mass_own);
    displacement_ += move.lazyProduct(row.force);
  }
}

double ReducedContact::push(std::size_t c) {
  Row& row = rows_[c];
  if (row.own == 0.0) return 0.0;  // a fixed vertex
  const auto k = static_cast<Eigen::Index>(3 * c);
  const double gap = gradients_.col(k).dot(displacement_) - row.target[0];
  const double change =
      std::max(-(gap + softness_ * row.force[0]) / (row.own + softness_), -row.force[0]);
  row.force[0] += change;
  displacement_ += change * moves_.col(k);
  const double moved = row.own * std::abs(change);
  const bool is_open = row.force[0] == 0.0 && row.force.tail<2>().isZero(0.0);
  if (bounds_[c] == 0.0 || is_open) return moved;
  // Softer than a sticking point by what the force differs from the last one's, so that it does not
  // creep under a steady force.
  const auto tangents = gradients_.middleCols<2>(k + 1);
  const Eigen::Vector2d slip = tangents.transpose().lazyProduct(displacement_) -
                               row.target.tail<2>() + softness_ * (row.force - row.known).tail<2>();
  const double own = row.own_tangent + softness_;
  const Eigen::Vector2d wanted =
      within(row.force.tail<2>() - slip / own, bounds_[c] * row.force[0]);
  const Eigen::Vector2d turn = wanted - row.force.tail<2>();
  row.force.tail<2>() = wanted;
  displacement_ += moves_.middleCols<2>(k + 1).lazyProduct(turn);
  return std::max(moved, row.own_tangent * turn.norm());
}

void ReducedContact::solve_positions(double small) {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double largest = 0.0;
    for (std::size_t c = 0; c < rows_.size(); ++c) largest = std::max(largest, push(c));
    if (largest <= small) break;
  }
}

double ReducedContact::slow(std::size_t c, double h, Eigen::VectorXd& p) {
  Row& row = rows_[c];
  if (row.force[0] == 0.0) return 0.0;
  const auto k = static_cast<Eigen::Index>(3 * c);
  const double speed = gradients_.col(k).dot(p) - row.surface_speed[0];
  const double change =
      std::max(-(speed + mass_softness_ * row.impulse[0]) / (row.mass_own + mass_softness_),
               -(h * row.force[0] + row.impulse[0]));
  row.impulse[0] += change;
  p += change * gradients_.col(k);
  const double moved = row.mass_own * std::abs(change);
  if (bounds_[c] == 0.0) return moved;
  const auto tangents = gradients_.middleCols<2>(k + 1);
  const Eigen::Vector2d slip = tangents.transpose().lazyProduct(p) - row.surface_speed.tail<2>() +
                               mass_softness_ * row.impulse.tail<2>();
  const Eigen::Vector2d held = (h * row.force + row.impulse).tail<2>();
  const Eigen::Vector2d wanted = within(held - slip / (row.mass_tangent + mass_softness_),
                                        bounds_[c] * (h * row.force[0] + row.impulse[0]));
  const Eigen::Vector2d turn = wanted - held;
  row.impulse.tail<2>() += turn;
  p += tangents.lazyProduct(turn);
  return std::max(moved, row.mass_tangent * turn.norm());
}

void ReducedContact::solve_velocities(double h, double small, Eigen::VectorXd& p) {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double largest = 0.0;
    for (std::size_t c = 0; c < rows_.size(); ++c) largest = std::max(largest, slow(c, h, p));
    if (largest <= small) break;
  }
}

bool ReducedContact::add_late(const Step& step, ReducedSystem& system) {
  std::vector<Contact>& contacts = step.effect.contacts();
  late_.clear();
  step.effect.find(late_);
  const std::size_t first = contacts.size();
  for (const Contact& late : late_) {
    if (late.normal.dot(points_.position(system.particles.x, late.point)) >= late.plane) continue;
    const auto is_same = [&](const Contact& c) {
      return c.point == late.point && c.obstacle == late.obstacle;
    };
    if (std::none_of(contacts.begin(), contacts.end(), is_same)) contacts.push_back(late);
  }
  if (contacts.size() == first) return false;
  add_rows(first, step, system);
  return true;
}

void ReducedContact::begin(const Step& step, ReducedSystem& system) {
  step.response.to_q(guess_, moved_);
  system.q -= moved_;
  step.response.to_p(guess_, moved_);
  system.p -= moved_;
  vertices_.positions(system.q, system.particles.x);
  step.effect.begin_step(system.particles, step.h);
  rows_.clear();
  softness_ = mass_softness_ = 0.0;
  is_shifted_ = false;
  displacement_ = system.q - step.q_start;
  add_rows(0, step, system);
}

void ReducedContact::shift(const Eigen::VectorXd& displacement) {
  displacement_ += displacement;
  is_shifted_ = true;
}

void ReducedContact::hold(const Step& step, ReducedSystem& system) {
  if (rows_.empty() && !is_shifted_) return;
  const double small = kSmallMove * step.effect.offset();
  for (int round = 0;; ++round) {
    solve_positions(small);
    system.q = step.q_start + displacement_;
    vertices_.positions(system.q, system.particles.x);
    if (round == kLateRounds || !add_late(step, system)) break;
  }
}

void ReducedContact::end(const Step& step, ReducedSystem& system) {
  guess_.setZero();
  const auto columns = static_cast<Eigen::Index>(3 * rows_.size());
  for (Eigen::Index k = 0; k < columns; ++k) {
    guess_ += rows_[static_cast<std::size_t>(k / 3)].force[k % 3] * gradients_.col(k);
  }
  if (!rows_.empty()) {
    step.response.to_p(guess_, moved_);
    system.p += moved_;
  }
  stop(step, system);
}

void ReducedContact::stop(const Step& step, ReducedSystem& system) {
  solve_velocities(step.h, kSmallMove * step.effect.offset() / step.h, system.p);
  keep(step.effect.contacts(), step.h);
}

void ReducedContact::keep(std::vector<Contact>& contacts, double h) {
  touches_.clear();
  guess_.setZero();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Row& row = rows_[c];
    const Eigen::Vector3d force = row.force + row.impulse / h;
    contacts[c].normal_force = force[0];
    contacts[c].friction_force = row.axes.rightCols<2>() * force.tail<2>();
    if (force[0] == 0.0) continue;
    touches_.push_back(
        {contacts[c].obstacle, contacts[c].point, force[0], contacts[c].friction_force});
    guess_ += gradients_.middleCols<3>(static_cast<Eigen::Index>(3 * c)).lazyProduct(force);
  }
  std::sort(touches_.begin(), touches_.end(), is_before<Touch, Touch>);
}

void ReducedContact::save(StateArchive& numbers) const {
  numbers.write_all(guess_);
  numbers.write(static_cast<double>(touches_.size()));
  for (const Touch& touch : touches_) {
    numbers.write(touch.obstacle);
    numbers.write(touch.point);
    numbers.write(touch.normal_force);
    numbers.write_all(touch.friction_force);
  }
}

void ReducedContact::load(StateArchive& numbers) {
  numbers.read_all(guess_);
  constexpr std::size_t kNumbersOfEach = 6;
  touches_.resize(numbers.read_count(kNumbersOfEach));
  for (Touch& touch : touches_) {
    touch.obstacle = numbers.read_int();
    touch.point = numbers.read_int();
    touch.normal_force = numbers.read();
    numbers.read_all(touch.friction_force);
  }
}

}  // namespace pliant
