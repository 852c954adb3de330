#pragma once

#include "pliant/effects/air/air.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/worlds/worlds.h"

namespace pliant {

/// The thesis's experiment: a cloth sealed over a plane, held by its middle and lifted.
class Tent {
 public:
  /// `volume` of air at atmospheric pressure [m³]; the cloth starts as a dome that holds it.
  Tent(const std::string& solver, double dt, double volume,
       const ParameterText& solver_parameters = {}, bool seal_breaks = false) {
    ClothScene s;
    s.grid = {kWidth, kWidth, kNodes, kNodes};
    s.solver = solver;
    s.solver_parameters = solver_parameters;
    s.time_step = dt;
    s.obstacles = {obstacle(Plane())};
    s.pose = at(0, 0, kGround);
    for (int r = -1; r <= 1; ++r) {
      for (int c = -1; c <= 1; ++c) held_.push_back(vertex(s.grid, kNodes / 2 + r, kNodes / 2 + c));
    }
    s.fixed = held_;
    s.effects = {
        {"gravity", {}},
        {"damping", {{"rate", "5"}}},
        {"air",
         {{"volume", std::to_string(volume)}, {"seal_breaks", seal_breaks ? "true" : "false"}}},
        {"contact", {}}};
    world_ = make_world(s);
    rise_to(volume);
  }

  World& world() { return *world_; }
  Particles& particles() { return particles_of(*world_); }
  AirEffect& air() { return effect_of<AirEffect>(*world_, "air"); }
  const std::vector<int>& held() const { return held_; }

  /// One step in which the held vertices have risen by `rise`.
  bool lift(double rise) {
    for (int i : held_) particles().x(2, i) += rise;
    return world_->step();
  }
  /// Of all bubbles [J].
  double pressure_times_volume() {
    double sum = 0.0;
    for (const Bubble& bubble : air().bubbles()) {
      sum += (kAtmosphere + bubble.gauge) * air().volume(bubble, particles().x);
    }
    return sum;
  }

  /// The cloth's triangles, with the shares of their corners.
  CoverTriangles cover() const {
    return CoverTriangles(make_grid({kWidth, kWidth, kNodes, kNodes}));
  }

  static constexpr double kAtmosphere = 101325.0, kWidth = 0.3, kGround = 0.001;
  static constexpr int kNodes = 13;

 private:
  /// A dome h (1 - u²) (1 - v²), scaled until it holds `volume`.
  void rise_to(double volume) {
    Particles& p = particles();
    const CoverTriangles cover = this->cover();
    const auto dome = [&](double height) {
      for (int i = 0; i < p.size(); ++i) {
        const double u = 2.0 * p.x(0, i) / kWidth, v = 2.0 * p.x(1, i) / kWidth;
        p.x(2, i) = kGround + height * (1.0 - u * u) * (1.0 - v * v);
      }
      return column_volume(cover, p.x, {Eigen::Vector3d::UnitZ(), kGround});
    };
    // The volume is proportional to the height.
    dome(volume / dome(1.0));
    world_->set_initial_state();
  }

  std::unique_ptr<World> world_;
  std::vector<int> held_;
};

}  // namespace pliant
