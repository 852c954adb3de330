#pragma once

#include <utility>

#include "pliant/effects/body_contact/body_surfaces.h"
#include "pliant/effects/contact/pair_detection.h"
#include "pliant/effects/contact/redundant_contacts.h"
#include "pliant/effects/self_contact/sheet_tree_search.h"

namespace pliant {

/// Finds where the surfaces of a group's bodies come near each other: vertices with triangles and
/// edges with edges, on their straight paths from a step's start to its end, so that no corner
/// slips between vertices.
class BodyContactDetection final : public PairDetection {
 public:
  /// Of bodies where they are now. Throws InputError where two pass through each other: nothing
  /// says to which side they belong.
  BodyContactDetection(const Group& group, const BodyPairTable& pairs, const Options& options);

  void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) override;
  bool is_final() const override { return false; }
  void find_again(const Particles& particles, double dt,
                  std::vector<PairContact>& contacts) override;
  bool limit_displacement(const Particles& particles, double dt, Positions& x,
                          std::vector<PairContact>& contacts) override;
  double take_search_seconds() override { return std::exchange(search_seconds_, 0.0); }

  /// Bodies that began nearer than they should be part slowly: a step of `dt` [s] begins.
  void open(double dt);
  double thickness() const { return search_.thickness(); }  ///< that is kept, at the most [m]
  /// By how much they have parted so far, at the most [m].
  double opened() const { return opened_; }
  void set_opened(double opened) { opened_ = opened; }
  /// Of a contact that it found.
  std::pair<int, int> bodies_of(const PairContact& contact) const;
  /// Whether one of its bodies keeps its shape.
  bool is_of_rigid(const PairContact& contact) const;
  const BodySurfaces& surfaces() const { return surfaces_; }

 private:
  /// What of their distances is missing at the start.
  void find_missing(const Positions& vertices);
  std::pair<int, int> bodies_of(const SheetNearPair& found) const;
  std::size_t place_of(int one, int other) const {
    return static_cast<std::size_t>(one * pairs_.bodies() + other);
  }
  void search(const Particles& particles);
  /// Of what was found, behind the `kept` first ones, in the order of the particles' numbers: the
  /// search has one of its own, by where bodies are, and sweeps that end before they converge would
  /// give another result where a scene is turned.
  void make_contacts(double dt, std::size_t kept, std::vector<PairContact>& contacts);
  PairContact contact(const SheetNearPair& found, double dt) const;
  /// Keeps those behind the `kept` first ones that others do not say already.
  void leave_out_redundant(std::size_t kept, std::vector<PairContact>& contacts);
  /// Where a contact of two rigid bodies is.
  RedundantContacts::Place place_of(const SheetNearPair& found, const PairContact& contact) const;
  /// Of two surfaces that touch, the direction in which the first should leave.
  Eigen::Vector3d direction_out(const SheetNearPair& found) const;
  /// Moves particles by the shares of displacement that the vertices they carry may go, and these.
  void go_back(const Particles& particles, const std::vector<double>& shares, Positions& vertices);

  const Group& group_;
  BodySurfaces surfaces_;
  SheetTreeSearch search_;
  BodyPairTable pairs_;
  double reach_;
  std::vector<double> missing_;  // of two bodies' distance at the start, row by row [m]
  double most_missing_ = 0.0, opened_ = 0.0;  // [m]
  double search_seconds_ = 0.0;
  // Of the running step.
  Positions start_, end_;    // of vertices [m]
  Positions from_, wanted_;  // of particles: where the rest of the path begins, and ends [m]
  Positions reached_;        // of particles [m]
  std::vector<double> particle_shares_;
  bool are_far_apart_ = false;
  SheetNearPairs found_;
  std::vector<std::size_t> order_;  // of what was found
  RedundantContacts redundant_;
  std::vector<std::size_t> rigid_;  // contacts of two rigid bodies
};

}  // namespace pliant
