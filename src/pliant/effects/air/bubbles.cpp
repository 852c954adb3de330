#include "pliant/effects/air/bubbles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {
namespace {

// Of a vertex that lies: below, wet cloth seals [m].
constexpr double kLying = 1e-5;
// Weighs vertices that have no height.
constexpr double kTinyHeight = 1e-9;  // [m]
// Of a lifted vertex that no flood came to yet.
constexpr int kUnseen = -2;

bool is_any_in_two(const std::vector<Bubble>& bubbles, std::size_t vertices) {
  if (bubbles.size() < 2) return false;
  std::vector<char> is_in_one(vertices, 0);
  for (const Bubble& bubble : bubbles) {
    for (const int i : bubble.vertices) {
      char& known = is_in_one[static_cast<std::size_t>(i)];
      if (known != 0) return true;
      known = 1;
    }
  }
  return false;
}

}  // namespace

Bubbles::Bubbles(const Positions& rest, const Eigen::Matrix3Xi& triangles)
    : triangles_(TriangleMesh{rest, triangles}),
      triangle_areas_(triangles.cols()),
      vertex_areas_(voronoi_areas({rest, triangles})),
      labels_(static_cast<std::size_t>(rest.cols()), -1) {
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = rest.col(triangles(1, t)) - rest.col(triangles(0, t));
    triangle_areas_[t] =
        0.5 * a.cross(rest.col(triangles(2, t)) - rest.col(triangles(0, t))).norm();
  }
  const Edges edges = pliant::edges({rest, triangles});
  first_neighbor_.assign(labels_.size() + 1, 0);
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    ++first_neighbor_[static_cast<std::size_t>(a) + 1];
    ++first_neighbor_[static_cast<std::size_t>(b) + 1];
    if (edges.opposite[e][1] >= 0) continue;
    rim_.push_back({a, b});
    rim_lengths_.push_back((rest.col(a) - rest.col(b)).norm());
  }
  std::partial_sum(first_neighbor_.begin(), first_neighbor_.end(), first_neighbor_.begin());
  rebuild();
  neighbors_.resize(2 * edges.vertices.size());
  std::vector<int> at(first_neighbor_.begin(), first_neighbor_.end() - 1);
  for (const auto& [a, b] : edges.vertices) {
    neighbors_[static_cast<std::size_t>(at[static_cast<std::size_t>(a)]++)] = b;
    neighbors_[static_cast<std::size_t>(at[static_cast<std::size_t>(b)]++)] = a;
  }
}

void Bubbles::clear() {
  std::fill(labels_.begin(), labels_.end(), -1);
  rebuild();
}

bool Bubbles::label(const Eigen::VectorXd& heights, bool all_lifted) {
  next_.assign(labels_.size(), -1);
  // Air whose cloth came to lie stays where it is.
  flat_.assign(bubbles_.size(), 1);
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (labels_[i] >= 0 && heights[static_cast<Eigen::Index>(i)] > kLying) {
      flat_[static_cast<std::size_t>(labels_[i])] = 0;
    }
  }
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    bool is_lifted = all_lifted || heights[static_cast<Eigen::Index>(i)] > kLying;
    if (!is_lifted && labels_[i] >= 0) {
      const auto own = static_cast<std::size_t>(labels_[i]);
      is_lifted = flat_[own] != 0 && bubbles_[own].amount > 0.0 && !bubbles_[own].is_open;
    }
    if (is_lifted) next_[i] = kUnseen;
  }
  int count = 0;
  for (std::size_t i = 0; i < next_.size(); ++i) {
    if (next_[i] == kUnseen) flood(static_cast<int>(i), count++);
  }
  return next_ != labels_;
}

void Bubbles::flood(int seed, int bubble) {
  open_.assign(1, seed);
  next_[static_cast<std::size_t>(seed)] = bubble;
  while (!open_.empty()) {
    const auto i = static_cast<std::size_t>(open_.back());
    open_.pop_back();
    for (int k = first_neighbor_[i]; k < first_neighbor_[i + 1]; ++k) {
      const int other = neighbors_[static_cast<std::size_t>(k)];
      int& own = next_[static_cast<std::size_t>(other)];
      if (own != kUnseen) continue;
      own = bubble;
      open_.push_back(other);
    }
  }
}

std::vector<int> Bubbles::owners() const {
  std::vector<int> owners(static_cast<std::size_t>(triangles_.size()), -1);
  std::vector<int> corners(labels_.size(), -1);
  const auto corner = [&](Eigen::Index t, int k) -> int& {
    return corners[static_cast<std::size_t>(triangles_.corners(k, t))];
  };
  // Those with a lifted corner, then those around them: a cloth may rise by more than one in a
  // step.
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<int>& from = pass == 0 ? labels_ : corners;
    for (Eigen::Index t = 0; t < triangles_.size(); ++t) {
      int& owner = owners[static_cast<std::size_t>(t)];
      for (int k = 0; k < 3 && owner < 0; ++k) {
        owner = from[static_cast<std::size_t>(triangles_.corners(k, t))];
      }
    }
    if (pass > 0) break;
    for (Eigen::Index t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        corner(t, k) = std::max(corner(t, k), owners[static_cast<std::size_t>(t)]);
      }
    }
  }
  return owners;
}

void Bubbles::rebuild() {
  int count = 0;
  for (const int label : labels_) count = std::max(count, label + 1);
  bubbles_.assign(static_cast<std::size_t>(count), Bubble());
  const std::vector<int> owners = this->owners();
  std::vector<int> local(labels_.size(), -1);
  for (int b = 0; b < count; ++b) {
    add_members(owners, b, local, bubbles_[static_cast<std::size_t>(b)]);
  }
  share_vertices_ = is_any_in_two(bubbles_, labels_.size());
  lying_ = Bubble();
  add_members(owners, -1, local, lying_);
  for (std::size_t e = 0; e < rim_.size(); ++e) {
    const int own = std::max(labels_[static_cast<std::size_t>(rim_[e][0])],
                             labels_[static_cast<std::size_t>(rim_[e][1])]);
    if (own >= 0) bubbles_[static_cast<std::size_t>(own)].edge_length += rim_lengths_[e];
  }
}

void Bubbles::add_members(const std::vector<int>& owners, int number, std::vector<int>& local,
                          Bubble& bubble) const {
  std::vector<Eigen::Index> own;
  for (Eigen::Index t = 0; t < triangles_.size(); ++t) {
    if (owners[static_cast<std::size_t>(t)] == number) own.push_back(t);
  }
  bubble.triangles.corners.resize(3, static_cast<Eigen::Index>(own.size()));
  bubble.triangles.shares.resize(3, static_cast<Eigen::Index>(own.size()));
  std::vector<double> areas;
  for (std::size_t t = 0; t < own.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int i = triangles_.corners(k, own[t]);
      int& at = local[static_cast<std::size_t>(i)];
      if (at < 0) {
        at = static_cast<int>(bubble.vertices.size());
        bubble.vertices.push_back(i);
        areas.push_back(0.0);
      }
      areas[static_cast<std::size_t>(at)] += triangle_areas_[own[t]] * triangles_.shares(k, own[t]);
      bubble.triangles.corners(k, static_cast<Eigen::Index>(t)) = at;
    }
    bubble.triangles.shares.col(static_cast<Eigen::Index>(t)) = triangles_.shares.col(own[t]);
  }
  bubble.areas = Eigen::Map<Eigen::VectorXd>(areas.data(), static_cast<Eigen::Index>(areas.size()));
  bubble.gradient.setZero(3, bubble.areas.size());
  for (const int i : bubble.vertices) local[static_cast<std::size_t>(i)] = -1;
}

std::vector<Bubbles::AirTransfer> Bubbles::transfers(const std::vector<int>& before,
                                                     const Eigen::VectorXd& heights) const {
  std::vector<AirTransfer> transfers;
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (before[i] < 0 || labels_[i] < 0) continue;
    const auto known =
        std::find_if(transfers.begin(), transfers.end(), [&](const AirTransfer& transfer) {
          return transfer.from == before[i] && transfer.to == labels_[i];
        });
    const auto v = static_cast<Eigen::Index>(i);
    const double weight = vertex_areas_[v] * (heights[v] + kTinyHeight);
    if (known == transfers.end()) {
      transfers.push_back({before[i], labels_[i], weight});
    } else {
      known->weight += weight;
    }
  }
  return transfers;
}

void Bubbles::share_out(const std::vector<Bubble>& before,
                        const std::vector<AirTransfer>& transfers,
                        const std::vector<double>& volumes, double& loose) {
  std::vector<double> weights(bubbles_.size(), 0.0);
  for (const AirTransfer& transfer : transfers)
    weights[static_cast<std::size_t>(transfer.to)] += transfer.weight;
  for (std::size_t b = 0; b < before.size(); ++b) {
    // Parts of one bubble have its pressure: each gets as much of its air as it has of its volume.
    const auto volume = [&](const AirTransfer& transfer) {
      const auto to = static_cast<std::size_t>(transfer.to);
      return (volumes[to] + kTinyHeight * kTinyHeight) * transfer.weight / weights[to];
    };
    double all = 0.0, left = before[b].amount;
    const AirTransfer* last = nullptr;
    for (const AirTransfer& transfer : transfers) {
      if (transfer.from != static_cast<int>(b)) continue;
      all += volume(transfer);
      last = &transfer;
    }
    for (const AirTransfer& transfer : transfers) {
      if (transfer.from != static_cast<int>(b)) continue;
      Bubble& to = bubbles_[static_cast<std::size_t>(transfer.to)];
      double share = &transfer == last ? left : before[b].amount * (volume(transfer) / all);
      // What was open is full of the room's air.
      if (before[b].is_open) share = volume(transfer);
      to.amount += share;
      to.gauge = before[b].gauge;
      left -= share;
    }
    if (last == nullptr && !before[b].is_open) loose += before[b].amount;
  }
}

void Bubbles::open_lifted(const Eigen::VectorXd& heights, double gap) {
  for (Bubble& bubble : bubbles_) bubble.is_open = false;
  for (const auto& edge : rim_) {
    for (const int i : edge) {
      const int own = labels_[static_cast<std::size_t>(i)];
      if (own >= 0 && heights[i] > gap) bubbles_[static_cast<std::size_t>(own)].is_open = true;
    }
  }
}

void Bubbles::take_in(double loose, const Eigen::VectorXd& heights) {
  if (bubbles_.empty()) {
    label(heights, true);
    labels_ = next_;
    rebuild();
  }
  double sealed = 0.0;
  for (const Bubble& bubble : bubbles_) sealed += bubble.is_open ? 0.0 : bubble.areas.sum();
  // With open edges alone it goes into the room.
  if (sealed == 0.0) return;
  double left = loose;
  Bubble* last = nullptr;
  for (Bubble& bubble : bubbles_) {
    if (bubble.is_open) continue;
    const double share = loose * (bubble.areas.sum() / sealed);
    bubble.amount += share;
    left -= share;
    last = &bubble;
  }
  last->amount += left;
}

void Bubbles::save(StateArchive& numbers) const {
  for (const int label : labels_) numbers.write(label);
  for (const Bubble& bubble : bubbles_) {
    for (double number : {bubble.amount, bubble.gauge, bubble.is_open ? 1.0 : 0.0}) {
      numbers.write(number);
    }
  }
}

void Bubbles::load(StateArchive& numbers) {
  const auto most = static_cast<std::int64_t>(labels_.size()) - 1;
  for (int& label : labels_) label = static_cast<int>(numbers.read_whole(-1, most));
  rebuild();
  for (Bubble& bubble : bubbles_) {
    bubble.amount = numbers.read();
    bubble.gauge = numbers.read();
    bubble.is_open = numbers.read() == 1.0;
  }
}

}  // namespace pliant
