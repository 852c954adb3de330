#include "pliant/elements/solids/material_damping.h"

#include <utility>

namespace pliant {

ParameterSpec material_damping_parameter() {
  return number_parameter("damping", "s", "0", 0.0, 1e3,
                          "Kelvin-Voigt: viscosity over stiffness; a vibration of circular "
                          "frequency w has the damping ratio w/2 times it; 0: none");
}

void add_damping(ProjectiveSystem& system, std::size_t first, double time) {
  if (time == 0.0) return;
  std::vector<std::unique_ptr<ElementSet>> viscous;
  for (std::size_t k = first; k < system.elements.size(); ++k) {
    system.elements[k]->add_damping(time, viscous);
  }
  for (auto& set : viscous) system.elements.push_back(std::move(set));
}

}  // namespace pliant
