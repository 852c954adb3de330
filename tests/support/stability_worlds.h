#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pliant/elements/spring_set.h"
#include "support/random.h"
#include "support/worlds.h"

namespace pliant {

/// Hard cases that every solver of cloth has to survive.
class HardCase : public EverySolver {
 protected:
  std::string solver() const { return GetParam(); }
};

inline bool iterates(const std::string& solver) {
  const auto& specs = solver_registry().find(solver).parameters;
  return std::any_of(specs.begin(), specs.end(),
                     [](const ParameterSpec& spec) { return spec.name == "iterations"; });
}

/// Solvers of cloth that iterate towards an implicit step, or those that step explicitly.
inline std::vector<std::string> cloth_solvers(bool iterating) {
  std::vector<std::string> names;
  for (const std::string& name : solver_registry().names_for("cloth")) {
    if (iterates(name) == iterating) names.push_back(name);
  }
  return names;
}

/// `iterations` for the solvers that iterate; nothing for the others.
inline ParameterText with_iterations(const std::string& solver, int iterations) {
  if (!iterates(solver)) return {};
  return {{"iterations", std::to_string(iterations)}};
}

inline bool warns(const Body& body, const std::string& text) {
  const auto& warnings = body.report.warnings;
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

/// The scene's time step, halved until its solver no longer calls it unstable.
inline double stable_step(ClothScene scene) {
  for (;; scene.time_step *= 0.5) {
    const auto world = make_world(scene);
    world->step();
    if (!warns(body_of(*world), "unstable_step")) return scene.time_step;
  }
}

inline std::unique_ptr<World> make_stable_world(ClothScene scene) {
  scene.time_step = stable_step(scene);
  return make_world(scene);
}

inline std::vector<int> row_of(const GridOptions& grid, int row) {
  std::vector<int> vertices;
  for (int c = 0; c < grid.columns; ++c) vertices.push_back(vertex(grid, row, c));
  return vertices;
}

inline Eigen::VectorXd stretch_strains(const World& world) {
  const Body& body = world.bodies().front();
  const auto& system = dynamic_cast<const ProjectiveSystem&>(body.model->system());
  const auto& springs = dynamic_cast<const SpringSet&>(*system.elements.front());
  return springs.strains(body.particles().x);
}

inline double largest_strain(const World& world) { return stretch_strains(world).maxCoeff(); }

inline double largest_speed(const World& world) {
  return world.bodies().front().particles().v.colwise().norm().maxCoeff();
}

/// Random displacements and velocities of the particles that are not fixed.
inline void disturb(World& world, double displacement, double speed, std::uint64_t seed = 1) {
  Random random(seed);
  Particles& particles = particles_of(world);
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    particles.x.col(i) += random.vector(displacement);
    particles.v.col(i) += random.vector(speed);
  }
}

/// Steps until `seconds` are over and returns the largest total energy seen, the start's included.
inline double largest_energy(World& world, double seconds) {
  double largest = world.energies().total();
  const double end = world.time() + seconds - 0.5 * world.time_step();
  while (world.time() < end) {
    if (!world.step()) {
      ADD_FAILURE() << body_of(world).report.failure;
      break;
    }
    largest = std::max(largest, world.energies().total());
  }
  return largest;
}

/// What a step that failed must have left untouched.
struct Snapshot {
  explicit Snapshot(World& world)
      : x(particles_of(world).x), v(particles_of(world).v), time(world.time()) {}

  /// Bit for bit, so that NaN equals itself.
  void expect_equal(World& world) const {
    const Particles& particles = particles_of(world);
    EXPECT_EQ(time, world.time());
    EXPECT_TRUE(same_bits(x, particles.x)) << "positions";
    EXPECT_TRUE(same_bits(v, particles.v)) << "velocities";
  }

  static bool same_bits(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    return a.cols() == b.cols() &&
           std::equal(a.data(), a.data() + a.size(), b.data(), [](double p, double q) {
             return p == q || (std::isnan(p) && std::isnan(q));
           });
  }

  Eigen::Matrix3Xd x, v;
  double time;
};

/// Moves one obstacle straight, from its first pose, and stops it after a while.
class StraightDriver final : public ObstacleDriver {
 public:
  StraightDriver(std::size_t obstacle, const Eigen::Isometry3d& start,
                 const Eigen::Vector3d& velocity, double duration)
      : obstacle_(obstacle), start_(start), velocity_(velocity), duration_(duration) {}

  void drive(double time, std::vector<Obstacle>& obstacles) override {
    const Eigen::Translation3d motion(std::min(time, duration_) * velocity_);
    obstacles[obstacle_].pose_end = motion * start_;
  }

 private:
  std::size_t obstacle_;
  Eigen::Isometry3d start_;
  Eigen::Vector3d velocity_;  // [m/s]
  double duration_;           // [s]
};

}  // namespace pliant

/// Runs the TEST_Ps of `suite`, a class derived from HardCase, for each solver of cloth, ...
#define PLIANT_FOR_EVERY_CLOTH_SOLVER(suite) \
  INSTANTIATE_TEST_SUITE_P(Solvers, suite,   \
                           testing::ValuesIn(solver_registry().names_for("cloth")), test_name_of)

/// ... or for those that iterate (true) or step explicitly (false).
#define PLIANT_FOR_CLOTH_SOLVERS_THAT_ITERATE(suite, iterating)                         \
  INSTANTIATE_TEST_SUITE_P(Solvers, suite, testing::ValuesIn(cloth_solvers(iterating)), \
                           test_name_of)
