#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/body/applied_force.h"
#include "pliant/core/body/model.h"
#include "pliant/core/effect.h"
#include "pliant/core/solver.h"
#include "pliant/core/step/step_report.h"

namespace pliant {

class Group;

/// One deformable object: a model, the solver that moves it, and the effects its scene calls for.
struct Body {
  std::string name;
  std::unique_ptr<Model> model;
  std::shared_ptr<Solver> solver;  ///< bodies of a group with the same setting share it
  std::pair<std::string, ParameterText> solver_setting;  ///< name and given parameters
  Group* group = nullptr;  ///< of the bodies that it moves together; the world's
  std::vector<std::unique_ptr<Effect>> effects;
  StepReport report;
  Particles initial;             ///< what a reset goes back to
  StateArchive initial_numbers;  ///< likewise, of the system
  StateArchive learned;          ///< by the solver, when this step began
  double solver_dt = 0.0;        ///< the step that the solver is prepared for [s]
  int substeps = 1;              ///< of the running step; 0: refused
  bool is_kept = false;          ///< whether the next two are of when the running step began
  Particles before;              ///< to go back to, where the step fails
  StateArchive before_numbers;   ///< likewise, of the system and of effects

  Particles& particles() { return model->particles(); }
  const Particles& particles() const { return model->particles(); }
  ForcePoints force_points() const { return {particles(), model->force_points()}; }
  /// Tells the solver that masses, pinned particles or elements changed.
  void prepare_solver(double dt);
  /// What one of its effects offers, the first that does; or null.
  template <class Service>
  Service* find() const {
    for (const auto& effect : effects) {
      if (auto* service = effect->find<Service>()) return service;
    }
    return nullptr;
  }
  /// The effect of that name, or null.
  Effect* find_effect(std::string_view effect_name) const;
};

}  // namespace pliant
