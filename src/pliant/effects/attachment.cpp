#include "pliant/effects/attachment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/core/body.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// Of a time step: times that differ by less are the same.
constexpr double kSameTime = 1e-6;

void write_text(const std::string& text, StateArchive& numbers) {
  numbers.write(static_cast<double>(text.size()));
  for (char c : text) numbers.write(c);
}

std::string read_text(StateArchive& numbers) {
  std::string text(numbers.read_count(), ' ');
  for (char& c : text) c = static_cast<char>(numbers.read_whole(-128, 127));
  return text;
}

}  // namespace

int find_holder(const std::string& name, const std::vector<Obstacle>& obstacles) {
  if (name == "world") return -1;
  std::vector<std::string> names = {"world"};
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const std::string& own = obstacles[o].link.empty() ? obstacles[o].name : obstacles[o].link;
    if (own == name) return static_cast<int>(o);
    if (std::find(names.begin(), names.end(), own) == names.end()) names.push_back(own);
  }
  throw InputError(
      unknown_name_message("obstacle or robot link with a collision shape", name, names));
}

std::vector<int> particles_to_hold(const Body& body, const Region& region, int first, int count) {
  const Particles& particles = body.particles();
  const EmbeddedPoints* points = body.model->force_points();
  if (points == nullptr) return particles_in(region, particles.x, first, count);
  Positions places(3, points->size());
  points->positions(particles.x, places);
  if (particles_in(region, places, 0, points->size()).empty()) return {};
  std::vector<int> all(static_cast<std::size_t>(particles.size()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<int> free_particles_to_hold(const Body& body, const Region& region, int first,
                                        int count) {
  const Particles& particles = body.particles();
  std::vector<int> found = particles_to_hold(body, region, first, count);
  found.erase(
      std::remove_if(found.begin(), found.end(), [&](int i) { return particles.is_fixed(i); }),
      found.end());
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

AttachmentSet& new_attachment_set(Body& body) {
  System& system = body.model->system();
  auto set = std::make_unique<AttachmentSet>(system.particles.size());
  AttachmentSet& made = *set;
  if (auto* projective = system.as_projective()) {
    projective->elements.push_back(std::move(set));
  } else if (auto* other = system.find<HoldsAttachments>()) {
    other->add_attachments(std::move(set));
  } else {
    throw InputError(fmt::format("bodies of the model '{}' cannot be held", body.model->name()));
  }
  return made;
}

void prepare_again(Body& body, double dt) {
  // A step may be taken in substeps.
  body.prepare_solver(body.solver_dt > 0.0 ? body.solver_dt : dt);
}

AttachmentEffect* find_attachments(Body& body) { return body.find<AttachmentEffect>(); }

const AttachmentEffect* find_attachments(const Body& body) { return body.find<AttachmentEffect>(); }

AttachmentEffect& attachments_of(Body& body, const std::vector<Obstacle>& obstacles) {
  if (AttachmentEffect* found = find_attachments(body)) return *found;
  auto own = std::make_unique<AttachmentEffect>(body, obstacles);
  AttachmentEffect& effect = *own;
  body.effects.push_back(std::move(own));
  return effect;
}

bool AttachmentEffect::has(const std::string& name) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.request.name == name && (entry.phase != Phase::kOver || !entry.is_user);
  });
}

std::vector<std::string> AttachmentEffect::names() const {
  std::vector<std::string> names;
  for (const Entry& entry : entries_) {
    if (entry.phase != Phase::kOver) names.push_back(entry.request.name);
  }
  return names;
}

void AttachmentEffect::check(const AttachmentRequest& request) const {
  if (has(request.name)) {
    throw InputError(fmt::format("the name '{}' is taken by another attachment", request.name));
  }
  if (!(std::isfinite(request.stiffness) && request.stiffness > 0.0)) {
    throw InputError(
        fmt::format("stiffness is {} N/m, but must be positive and finite", request.stiffness));
  }
  if (!(request.from >= 0.0 && request.until > request.from)) {
    throw InputError(
        fmt::format("it lasts from {} s until {} s, but must begin at 0 or later and "
                    "end after it began",
                    request.from, request.until));
  }
}

std::vector<int> AttachmentEffect::pick(const AttachmentRequest& request) const {
  std::vector<int> found =
      free_particles_to_hold(body_, request.region, request.first, request.count);
  if (found.empty()) {
    const auto all = particles_to_hold(body_, request.region, request.first, request.count).size();
    throw InputError(all == 0 ? std::string("no vertex is in its region")
                              : fmt::format("all {} vertices in its region are fixed", all));
  }
  return found;
}

AttachmentSet& AttachmentEffect::new_set() {
  if (spare_.empty()) return new_attachment_set(body_);
  AttachmentSet& set = *spare_.back();
  spare_.pop_back();
  return set;
}

void AttachmentEffect::begin(Entry& entry, const Eigen::Isometry3d& pose) {
  const Particles& particles = body_.particles();
  const std::vector<int> held = pick(entry.request);
  double mass = 0.0;
  for (int i : held) mass += particles.mass[i];
  for (int i : held) {
    entry.set->add(i, pose.inverse() * particles.x.col(i),
                   entry.request.stiffness * particles.mass[i] / mass);
  }
  entry.set->set_frame(pose);
  entry.phase = Phase::kHolding;
}

Eigen::Isometry3d AttachmentEffect::pose_start(const Entry& entry) const {
  const int o = entry.request.obstacle;
  return o < 0 ? Eigen::Isometry3d::Identity() : obstacles_[static_cast<std::size_t>(o)].pose_start;
}

Eigen::Isometry3d AttachmentEffect::pose_end(const Entry& entry) const {
  const int o = entry.request.obstacle;
  return o < 0 ? Eigen::Isometry3d::Identity() : obstacles_[static_cast<std::size_t>(o)].pose_end;
}

void AttachmentEffect::add(const AttachmentRequest& request) {
  check(request);
  if (request.from == 0.0) pick(request);
  Entry entry;
  entry.request = request;
  entry.set = &new_set();
  entries_.push_back(std::move(entry));
}

int AttachmentEffect::attach_now(AttachmentRequest request, double dt) {
  check(request);
  pick(request);
  Entry entry;
  entry.request = std::move(request);
  entry.is_user = true;
  entry.set = &new_set();
  begin(entry, pose_end(entry));
  entries_.push_back(std::move(entry));
  prepare_again(body_, dt);
  return entries_.back().set->size();
}

void AttachmentEffect::detach(const std::string& name, double dt) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.request.name == name && entry.phase != Phase::kOver;
  });
  if (found == entries_.end()) throw InputError(unknown_name_message("attachment", name, names()));
  found->set->clear();
  found->phase = Phase::kOver;
  if (found->is_user) {
    spare_.push_back(found->set);
    entries_.erase(found);
  }
  prepare_again(body_, dt);
}

void AttachmentEffect::change_elements(Body& body, double dt) {
  if (is_loaded_) {
    StateArchive learned;
    body.solver->save(learned);
    prepare_again(body_, dt);
    body.solver->load(learned);
    is_loaded_ = false;
  }
  const double end = body.report.time, start = end - dt, same = kSameTime * dt;
  bool changed = false;
  for (Entry& entry : entries_) {
    if (entry.phase == Phase::kWaiting && entry.request.from < end - same) {
      changed = true;
      try {
        begin(entry, pose_start(entry));
      } catch (const InputError& error) {
        entry.phase = Phase::kOver;
        body.report.warn(
            fmt::format("attachment: '{}' holds nothing: {}", entry.request.name, error.what()));
      }
    } else if (entry.phase == Phase::kHolding && entry.request.until <= start + same) {
      changed = true;
      entry.set->clear();
      entry.phase = Phase::kOver;
    }
  }
  if (changed) prepare_again(body_, dt);
}

void AttachmentEffect::before_step(Body&, double) {
  for (Entry& entry : entries_) {
    if (entry.phase == Phase::kHolding) entry.set->move_frame(pose_start(entry), pose_end(entry));
  }
}

bool AttachmentEffect::join_resident_run(ResidentRun& run) const {
  if (is_loaded_) return false;
  const double now = body_.report.time;
  for (const Entry& entry : entries_) {
    if (entry.phase == Phase::kOver) continue;
    const bool waits = entry.phase == Phase::kWaiting;
    // The force on an obstacle is a mean of those of the step's substeps.
    if (!waits && run.substeps > 1 && entry.request.obstacle >= 0) return false;
    // The step in which it begins or ends is none of the run.
    const double left = (waits ? entry.request.from : entry.request.until) - now;
    const double steps = std::floor(left / run.step_time - kSameTime);
    run.steps = static_cast<int>(std::min<double>(run.steps, std::max(0.0, steps)));
  }
  return true;
}

void AttachmentEffect::add_reactions(std::vector<Reaction>& reactions) const {
  for (const Entry& entry : entries_) {
    if (entry.phase != Phase::kHolding || entry.request.obstacle < 0) continue;
    Reaction& reaction = reactions[static_cast<std::size_t>(entry.request.obstacle)];
    const Eigen::Matrix<double, 6, 1> wrench = entry.set->wrench(body_.particles().x);
    reaction.force += wrench.head<3>();
    reaction.torque += wrench.tail<3>();
  }
}

void AttachmentEffect::add_held(std::vector<Eigen::Vector3d>& points) const {
  for (const Entry& entry : entries_) {
    for (const AttachmentSet::Attachment& held : entry.set->attachments()) {
      points.emplace_back(body_.particles().x.col(held.particle));
    }
  }
}

void AttachmentEffect::add_anchors(std::vector<Anchor>& anchors) const {
  for (const Entry& entry : entries_) {
    if (entry.phase != Phase::kHolding || entry.set->attachments().empty()) continue;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const AttachmentSet::Attachment& held : entry.set->attachments()) middle += held.point;
    middle /= static_cast<double>(entry.set->attachments().size());
    anchors.push_back({entry.request.name, pose_end(entry) * Eigen::Translation3d(middle)});
  }
}

void AttachmentEffect::reset(Body&) {
  for (Entry& entry : entries_) {
    entry.set->clear();
    entry.phase = Phase::kWaiting;
    if (entry.is_user) spare_.push_back(entry.set);
  }
  entries_.erase(
      std::remove_if(entries_.begin(), entries_.end(), [](const Entry& e) { return e.is_user; }),
      entries_.end());
  is_loaded_ = false;
}

void AttachmentEffect::save(StateArchive& numbers) const {
  numbers.write(static_cast<double>(entries_.size()));
  for (const Entry& entry : entries_) {
    write_text(entry.request.name, numbers);
    numbers.write(static_cast<double>(entry.phase));
    numbers.write(entry.request.obstacle);
    entry.set->write(numbers);
  }
}

void AttachmentEffect::load(StateArchive& numbers) {
  const std::size_t count = numbers.read_count();
  for (std::size_t n = 0; n < count; ++n) {
    if (n == entries_.size()) {
      Entry entry;
      entry.is_user = true;
      entry.set = &new_set();
      entries_.push_back(std::move(entry));
    }
    Entry& entry = entries_[n];
    entry.request.name = read_text(numbers);
    entry.phase = static_cast<Phase>(numbers.read_index(kPhases));
    entry.request.obstacle =
        static_cast<int>(numbers.read_whole(-1, static_cast<std::int64_t>(obstacles_.size()) - 1));
    entry.set->read(numbers);
  }
  is_loaded_ = true;
}

}  // namespace pliant
