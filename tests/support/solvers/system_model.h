#pragma once

#include <memory>
#include <string>
#include <utility>

#include "pliant/core/body/model.h"
#include "pliant/core/world.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/solvers/registry.h"

namespace pliant {

/// A bare projective system as a body, for tests that need no cloth: springs in space, a chain, a
/// heap of free particles. It goes by the name `cloth`, since solvers ask for it.
class SystemModel final : public Model {
 public:
  explicit SystemModel(const Positions& x, double mass_each = 1.0)
      : SystemModel(x, Eigen::VectorXd::Constant(x.cols(), mass_each)) {}
  SystemModel(const Positions& x, const Eigen::VectorXd& masses)
      : triangles_(3, 0), areas_(Eigen::VectorXd::Zero(x.cols())) {
    system_.particles = Particles(x, masses);
  }

  SystemModel& add(const std::string& name, const std::vector<Spring>& springs) {
    system_.elements.push_back(
        std::make_unique<SpringSet>(name, springs, system_.particles.size()));
    return *this;
  }
  SystemModel& add(std::unique_ptr<ElementSet> set) {
    system_.elements.push_back(std::move(set));
    return *this;
  }

  std::string_view name() const override { return "cloth"; }
  System& system() override { return system_; }
  const System& system() const override { return system_; }
  const Eigen::Matrix3Xi& surface_triangles() const override { return triangles_; }
  const Eigen::VectorXd& particle_areas() const override { return areas_; }
  std::map<std::string, Eigen::VectorXd> point_fields() const override { return {}; }

 private:
  ProjectiveSystem system_;
  Eigen::Matrix3Xi triangles_;
  Eigen::VectorXd areas_;
};

/// One point mass tied to a fixed one at the origin by a spring of 1 m; it lies along x.
inline std::unique_ptr<SystemModel> mass_on_spring(double mass, double stiffness, double length) {
  Positions x = Positions::Zero(3, 2);
  x(0, 1) = length;
  auto model = std::make_unique<SystemModel>(x, mass);
  model->add("stretch", {{0, 1, 1.0, stiffness}});
  model->particles().fix(0);
  return model;
}

/// A world with one body and its solver, ready to step.
inline std::unique_ptr<World> world_of(std::unique_ptr<Model> model, double dt,
                                       const std::string& solver,
                                       const ParameterText& parameters = {}) {
  auto world = std::make_unique<World>(dt);
  Body& body = world->add_body("body", std::move(model));
  world->set_solver(body, solver_registry(), solver, parameters, "test");
  world->set_initial_state();
  return world;
}

}  // namespace pliant
