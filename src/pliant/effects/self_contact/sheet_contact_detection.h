#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/effects/contact/pair_detection.h"
#include "pliant/effects/self_contact/sheet_tree_search.h"

namespace pliant {

/// Finds where a sheet without inside comes near itself: vertices and triangles, edges and edges,
/// along the whole path of a step. The side on which two places stay is that on which they first
/// came near, or were when the step began: so nothing passes, however thin and fast it is.
///
/// What is joined by an edge touches below half of its distance at rest, and the thickness is at
/// most half of the mean edge: else a smooth sheet would touch itself everywhere.
///
/// The search runs on the CPU, or on a device where one is given and the sheet is dry; where that
/// fails the CPU goes on.
class SheetContactDetection final : public PairDetection {
 public:
  /// `rest` 3 x n [m], all of `triangles`' vertices.
  SheetContactDetection(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                        const Options& options);

  void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) override;
  bool is_final() const override { return false; }
  void find_again(const Particles& particles, double dt,
                  std::vector<PairContact>& contacts) override;
  bool limit_displacement(const Particles& particles, double dt, Positions& x,
                          std::vector<PairContact>& contacts) override;
  int most_particles() const override { return 4; }
  int sweeps() const override { return 1; }
  std::size_t most_contacts() const override;
  /// Wet layers hold on to each other: a vertex to the nearest triangle on either side of it. Each
  /// of two layers brings half of the adhesion, of water that is the mean of both.
  void set_wetness(const WetContact* wet) override;
  void search_on_gpu(bool on_gpu) override;
  std::string take_device_failure() override { return std::exchange(device_failure_, {}); }
  double take_search_seconds() override { return std::exchange(search_seconds_, 0.0); }

  double sheet_thickness() const override { return cpu_.thickness(); }
  /// Searches there from the next step on; null: on the CPU.
  void set_device(std::unique_ptr<SheetSearch> device) { device_ = std::move(device); }
  bool has_device() const { return device_ != nullptr; }
  const SheetTreeSearch& search_on_cpu() const { return cpu_; }

 private:
  /// Of a step, on the device; false where the CPU has to do it.
  template <class Search>
  bool tries(const Search& search);
  void search(const Particles& particles);
  /// Of what was found, behind the `kept` first ones.
  void make_contacts(double dt, std::size_t kept, std::vector<PairContact>& contacts);
  PairContact contact(const SheetNearPair& found, double dt) const;
  /// What wet layers withstand, of all that was found [N].
  void stick();
  void stick(std::size_t begin, std::size_t end);
  /// Whether they are not of one place at rest.
  bool may_stick(const SheetNearPair& found) const;
  /// When the step began, twice the area long.
  Eigen::Vector3d normal_of(int vertex) const;
  /// Where two simplices lie on each other, the direction in which the first should leave.
  Eigen::Vector3d direction_out(const SheetNearPair& found) const;

  double friction_;
  const WetContact* wet_ = nullptr;  // null: all is dry
  SheetTreeSearch cpu_;
  std::unique_ptr<SheetSearch> device_;  // null: there is none
  std::string device_failure_;
  double search_seconds_ = 0.0;
  // Of the running step.
  const Positions* start_ = nullptr;  // of the straight paths [m]
  Positions reached_;                 // by the part of a step that is done [m]
  SheetNearPairs found_;
  std::vector<double> adhesions_;  // of those found [N]
};

}  // namespace pliant
