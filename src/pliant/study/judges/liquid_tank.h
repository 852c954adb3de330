#pragma once

#include "pliant/study/experiments/particle_scene.h"

namespace pliant {

/// Water that fills a box from the origin on, on the floor z = 0 between two walls that are normal
/// to y and as far apart as it is wide.
class LiquidTank {
 public:
  struct Options {
    Eigen::Vector3i counts;  ///< of particles
    double spacing;          ///< [m]
    double sound_speed;      ///< [m/s]
    double viscosity;        ///< [Pa s]
    double time_step;        ///< [s]
    double length;           ///< of the floor, from the wall x = 0 on [m]
    bool is_closed;          ///< whether a wall stands at its end
    bool has_gate;           ///< whether one holds the water until release()
  };
  explicit LiquidTank(const Options& options);

  /// One step. Throws std::runtime_error where it is not taken.
  void step();
  /// Lets the water come to rest behind its gate, and takes that away: time() begins here.
  void release();
  double time() { return scene_.world().time() - released_; }  ///< [s]
  double front();  ///< how far the water came along x [m]
  /// Height of the water within `width` of the wall x = 0 [m].
  double height_at_wall(double width);
  /// On the wall at the end, between two heights: its force over the area [Pa].
  double pressure_on_end(double low, double high);
  /// Of a particle [Pa].
  double pressure(int particle);
  Particles& particles() { return scene_.particles(); }
  World& world() { return scene_.world(); }

 private:
  Options options_;
  ParticleScene scene_;
  double released_ = 0.0;  // [s]
};

}  // namespace pliant
