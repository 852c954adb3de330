#include "pliant/effects/self_contact/sheet_contact_detection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/core/columns.h"
#include "pliant/core/step/timer.h"
#include "pliant/geometry/search/nearest_pair.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

// Contacts that a thread makes at once.
constexpr int kGrain = 128;
// Launches take longer than the search for what so few vertices touch.
constexpr int kLeastOnGpu = 500;
// Contacts for each vertex that are plausible. The thickness is at most half of an edge, so that
// layers that lie on each other, and what an edge passes in a step, give some tens.
constexpr std::size_t kMostOfAVertex = 100;

Eigen::Vector3d vector(const Double3& v) { return {v.x, v.y, v.z}; }

FourPoints corners_of(const Positions& x, const int* particles) {
  FourPoints corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = x.col(particles[k]);
  return corners;
}

}  // namespace

SheetContactDetection::SheetContactDetection(const Positions& rest,
                                             const Eigen::Matrix3Xi& triangles,
                                             const Options& options)
    : friction_(options.friction), cpu_(rest, triangles, options.thickness, options.margin) {}

std::size_t SheetContactDetection::most_contacts() const {
  return kMostOfAVertex * static_cast<std::size_t>(cpu_.mesh().vertices());
}

void SheetContactDetection::set_wetness(const WetContact* wet) {
  wet_ = wet;
  cpu_.set_margin(std::max(cpu_.margin(), wet->range));
}

void SheetContactDetection::search_on_gpu(bool on_gpu) {
  device_.reset();
  if (on_gpu && cpu_.mesh().vertices() >= kLeastOnGpu) device_ = make_cuda_sheet_search(cpu_);
}

template <class Search>
bool SheetContactDetection::tries(const Search& search) {
  if (!device_ || wet_ != nullptr) return false;
  try {
    search();
    return true;
  } catch (const DeviceFailure& failure) {
    device_failure_ = failure.what();
    device_.reset();
    return false;
  }
}

void SheetContactDetection::find(const Particles& particles, double dt,
                                 std::vector<PairContact>& contacts) {
  search(particles);
  make_contacts(dt, 0, contacts);
}

void SheetContactDetection::find_again(const Particles& particles, double dt,
                                       std::vector<PairContact>& contacts) {
  search(particles);
  make_contacts(dt, contacts.size(), contacts);
}

void SheetContactDetection::search(const Particles& particles) {
  const Timer timer;
  start_ = &particles.x_start;
  if (!tries([&] { found_ = device_->find(*start_, particles.x); })) {
    found_ = cpu_.find(*start_, particles.x);
  }
  search_seconds_ += timer.seconds();
}

bool SheetContactDetection::limit_displacement(const Particles& particles, double dt, Positions& x,
                                               std::vector<PairContact>& contacts) {
  const Timer timer;
  const bool had_device = has_device();
  bool is_free = true;
  if (!tries([&] { is_free = device_->limit_displacement(particles, x, found_); })) {
    // It has not seen this step yet.
    if (had_device) cpu_.find(*start_, x);
    is_free = cpu_.limit_displacement(particles, x, found_);
  }
  search_seconds_ += timer.seconds();
  if (is_free) return true;
  parallel_copy(x, reached_);
  start_ = &reached_;
  make_contacts(dt, 0, contacts);
  return false;
}

void SheetContactDetection::make_contacts(double dt, std::size_t kept,
                                          std::vector<PairContact>& contacts) {
  adhesions_.assign(found_.size(), 0.0);
  if (wet_ != nullptr) stick();
  // A heap has a contact for each two places. It is refused, so that no more than this are needed.
  const std::size_t most = most_contacts() + 1;
  const std::size_t made = std::min(found_.size(), most - std::min(kept, most));
  contacts.resize(kept + made);
  parallel_for(0, static_cast<int>(made), kGrain, [&](int begin, int end) {
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
      contacts[kept + k] = contact(found_[k], dt);
      contacts[kept + k].adhesion = adhesions_[k];
    }
  });
}

bool SheetContactDetection::may_stick(const SheetNearPair& found) const {
  const SheetMesh& mesh = cpu_.mesh();
  const SheetJoints joints = mesh.joints();
  if (joints.are_joined(found.kind, found.particles)) return false;
  const auto piece = [&](int k) {
    return mesh.pieces[static_cast<std::size_t>(found.particles[k])];
  };
  const double apart = sheet_pairs::rest_distance(joints, found.kind, found.particles);
  return piece(0) != piece(1) || sheet_pairs::kNearShare * apart > sheet_thickness() + wet_->range;
}

void SheetContactDetection::stick() {
  std::size_t begin = 0;
  while (begin < found_.size() && found_[begin].is_vertex()) {
    std::size_t end = begin + 1;
    while (end < found_.size() && found_[end].is_vertex() &&
           found_[end].particles[0] == found_[begin].particles[0]) {
      ++end;
    }
    stick(begin, end);
    begin = end;
  }
}

void SheetContactDetection::stick(std::size_t begin, std::size_t end) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  const auto nearest = [&](std::size_t across) {
    std::size_t best = kNone;
    for (std::size_t k = begin; k < end; ++k) {
      const PairApproach& own = found_[k].approach;
      if (own.start > found_[k].thickness + wet_->range || !may_stick(found_[k])) continue;
      if (across != kNone && dot(own.between, found_[across].approach.between) >= 0.0) continue;
      if (best == kNone || own.start < found_[best].approach.start) best = k;
    }
    return best;
  };
  const std::size_t one = nearest(kNone);
  if (one == kNone) return;
  for (const std::size_t side : {one, nearest(one)}) {
    if (side == kNone) continue;
    for (int k = 0; k < 4; ++k) {
      adhesions_[side] += 0.25 * std::abs(found_[side].approach.weights.of[k]) *
                          wet_->adhesion[found_[side].particles[k]];
    }
  }
}

Eigen::Vector3d SheetContactDetection::normal_of(int vertex) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int k : cpu_.mesh().triangles_of(vertex)) {
    const auto t = cpu_.mesh().triangles.col(k);
    const Eigen::Vector3d a = start_->col(t[1]) - start_->col(t[0]);
    sum += a.cross(start_->col(t[2]) - start_->col(t[0]));
  }
  return sum;
}

Eigen::Vector3d SheetContactDetection::direction_out(const SheetNearPair& found) const {
  const FourPoints at = corners_of(*start_, found.particles);
  if (!found.is_vertex()) {
    const Eigen::Vector3d across = (at.col(1) - at.col(0)).cross(at.col(3) - at.col(2));
    return across.z() < 0.0 ? -across : across;
  }
  const Eigen::Vector3d normal = (at.col(2) - at.col(1)).cross(at.col(3) - at.col(1));
  // Layers that face each other, as those of a fold do, both leave to the side that they turn to
  // each other; of others the order of their vertices decides, so that both agree.
  const Eigen::Vector3d own = normal_of(found.particles[0]);
  if (own.dot(normal) < 0.0) return normal;
  const bool is_first =
      found.particles[0] < *std::min_element(found.particles + 1, found.particles + 4);
  return is_first ? Eigen::Vector3d(-normal) : normal;
}

PairContact SheetContactDetection::contact(const SheetNearPair& found, double dt) const {
  PairContact contact;
  const Eigen::Vector3d between = vector(found.approach.between);
  const bool is_apart = between.norm() > sheet_pairs::kTouching * found.thickness;
  const Eigen::Vector3d out = is_apart ? between : direction_out(found);
  contact.normal = out.stableNormalized();
  if (contact.normal.isZero(0.0)) contact.normal = Eigen::Vector3d::UnitZ();
  contact.simplices[0] = static_cast<int>(found.kind);
  std::copy(found.particles, found.particles + 4, contact.simplices.begin() + 1);
  contact.count = 4;
  const double* weights = found.approach.weights.of;
  std::copy(found.particles, found.particles + 4, contact.particles.begin());
  std::copy(weights, weights + 4, contact.weights.begin());
  contact.friction = friction_;
  if (wet_ != nullptr) {
    double friction_factor = 0.0;
    for (int k = 0; k < 4; ++k) {
      friction_factor += 0.5 * std::abs(weights[k]) * wet_->friction_factor[found.particles[k]];
    }
    contact.friction *= friction_factor;
  }
  contact.start = contact.relative(*start_);
  contact.least = found.thickness;
  if (found.approach.time == 0.0) {
    const double gap = contact.normal.dot(contact.start);
    contact.least = std::min(contact.least, gap + kMaxPushOutSpeed * dt);
  }
  return contact;
}

}  // namespace pliant
