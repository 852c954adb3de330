#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cuda/effects/device_contact.h"
#include "pliant/core/step/resident_run.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// Obstacles at each particle that a device looks at; more of them are the host's work.
constexpr int kMostResidentObstacles = 8;

/// A shape as a device knows it, the samples of a mesh missing; nothing where it knows none.
std::optional<DeviceShape> device_shape(const Shape& shape);

/// Whether a device can take steps of the system without coming back: the constraints are contact
/// and friction of its particles with at most kMostResidentObstacles shapes.
bool can_stay_on_device(const ProjectiveSystem& system, const ResidentRun& run);

/// What contact and friction do in the run; `center` is the origin of the device's positions.
struct ResidentContact {
  ContactRules rules = {};
  std::vector<DeviceObstacle> obstacles;
  std::vector<std::shared_ptr<const Shape>> shapes;  ///< of the obstacles
  std::vector<int> numbers;                          ///< of the obstacles in the run
};
ResidentContact resident_contact(const ProjectiveSystem& system, const ResidentRun& run,
                                 const Eigen::Vector3d& center);

/// Contacts of earlier steps mean nothing after it.
void forget_contacts(ProjectiveSystem& system);

}  // namespace pliant
