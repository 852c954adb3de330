#pragma once

#include <Eigen/Core>

namespace pliant {

/// Of what is fully wet, as a share of how bright it is dry.
constexpr float kWetBrightness = 0.5f;

/// A body that takes up water: a model of such is one of these too.
class Wettable {
 public:
  virtual ~Wettable() = default;

  /// Shows the wetness of its particles, in [0, 1], as a field and by darker colours; it outlives
  /// this.
  virtual void show_wetness(const Eigen::VectorXd* wetness) = 0;
  /// The mass of a particle from the next step on [kg].
  virtual void set_mass(int particle, double mass) = 0;

  bool masses_changed = false;  ///< and the solver is told before the next step
};

}  // namespace pliant
