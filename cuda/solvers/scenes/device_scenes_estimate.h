#pragma once

#include "cuda/solvers/scenes/device_scenes.h"
#include "pliant/solvers/iterations/chebyshev.h"

/// The spectral radius with which steps of DeviceScenes begin.
namespace pliant {

template <class Executor>
void DeviceScenes<Executor>::upload_rules_of_unknown(double tolerance) {
  std::vector<StepRules> rules;
  for (DeviceScene* scene : bound_) {
    rules.push_back(rules_of(*scene));
    rules.back().is_due = is_unknown(*scene);
    rules.back().tolerance = tolerance;
  }
  step_->set_rules(rules);
}

template <class Executor>
bool DeviceScenes<Executor>::estimate() {
  if (key_.iterations <= key_.delay || !is_any_unknown()) return false;
  const std::vector<bool> says = estimate_by_plain_iterations();
  if (std::find(says.begin(), says.end(), true) != says.end()) estimate_radius();
  for (std::size_t s = 0; s < says.size(); ++s) {
    if (says[s]) bound_[s]->is_estimated = true;
  }
  upload_rules();
  return true;
}

template <class Executor>
std::vector<bool> DeviceScenes<Executor>::estimate_by_plain_iterations() {
  struct Search {
    double last = 0.0;
    bool is_done = false;
  };
  std::vector<Search> searches;
  for (const DeviceScene* scene : bound_) searches.push_back({0.0, !is_unknown(*scene)});
  upload_rules_of_unknown(0.0);
  for (int k = 0; k < ChebyshevSolver::kPreSimulation; ++k) {
    const auto is_done = [](const Search& search) { return search.is_done; };
    if (std::all_of(searches.begin(), searches.end(), is_done)) break;
    const std::vector<double> squared = step_->plain_iteration(k);
    for (std::size_t s = 0; s < bound_.size(); ++s) {
      Search& search = searches[s];
      if (search.is_done) continue;
      // |D^-1/2 r| from |J(y) - y|² / γ.
      const StepRules& rules = bound_[s]->rules;
      search.is_done = std::sqrt(squared[s] / rules.gamma) <= rules.noise;
      if (search.is_done) continue;
      if (search.last > 0.0) bound_[s]->estimate = std::sqrt(squared[s] / search.last);
      search.last = squared[s];
    }
  }
  std::vector<bool> says;
  for (const Search& search : searches) says.push_back(search.last > 0.0);
  return says;
}

template <class Executor>
void DeviceScenes<Executor>::estimate_radius() {
  upload_rules_of_unknown(ChebyshevSolver::kEstimateChange);
  step_->launch_iterations(ChebyshevSolver::kEstimateIterations);
  const std::vector<StepControl> control = step_->control();
  for (std::size_t s = 0; s < bound_.size(); ++s) {
    const bool is_finite = control[s].result != StepControl::kNotFinite;
    if (is_unknown(*bound_[s]) && is_finite) bound_[s]->estimate = control[s].radius;
  }
}

}  // namespace pliant
