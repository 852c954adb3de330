#include "cuda/effects/resident_exchange.h"

#include <algorithm>
#include <optional>

#include "pliant/core/system/find_constraint.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/effects/contact/friction.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

Float3 single(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

DeviceShape round_shape(DeviceShape::Kind kind, double radius, double length) {
  return {kind, single({radius, 0.5 * length, 0.0})};
}

/// Without samples, which the executor has.
DeviceShape grid_shape(const MeshShape& mesh) {
  const DistanceGrid& grid = mesh.grid();
  DeviceShape shape = {DeviceShape::kGrid, {}};
  for (int k = 0; k < 3; ++k) shape.grid.count[k] = grid.count[k];
  shape.grid.spacing = static_cast<float>(grid.spacing);
  shape.grid.origin = single(grid.origin);
  shape.grid.low = single(mesh.bounds().min());
  shape.grid.high = single(mesh.bounds().max());
  return shape;
}

bool are_known(const std::vector<Obstacle>& obstacles) {
  const auto is_solid = [](const Obstacle& o) { return !o.liquid; };
  if (std::count_if(obstacles.begin(), obstacles.end(), is_solid) > kMostResidentObstacles) {
    return false;
  }
  return std::all_of(obstacles.begin(), obstacles.end(),
                     [](const Obstacle& o) { return o.liquid || device_shape(*o.shape); });
}

DeviceObstacle device_obstacle(const Obstacle& obstacle, const Eigen::Vector3d& center) {
  DeviceObstacle result = {};
  result.shape = *device_shape(*obstacle.shape);
  for (int a = 0; a < 3; ++a) result.axes[a] = single(obstacle.pose_end.linear().col(a));
  result.position = single(obstacle.pose_end.translation() - center);
  return result;
}

}  // namespace

std::optional<DeviceShape> device_shape(const Shape& shape) {
  if (as<Plane>(shape) != nullptr) return DeviceShape{};
  if (const auto* sphere = as<Sphere>(shape)) {
    return round_shape(DeviceShape::kSphere, sphere->radius(), 0.0);
  }
  if (const auto* box = as<Box>(shape)) {
    return DeviceShape{DeviceShape::kBox, single(0.5 * box->size())};
  }
  if (const auto* capsule = as<Capsule>(shape)) {
    return round_shape(DeviceShape::kCapsule, capsule->radius(), capsule->length());
  }
  if (const auto* cylinder = as<Cylinder>(shape)) {
    return round_shape(DeviceShape::kCylinder, cylinder->radius(), cylinder->length());
  }
  if (const auto* mesh = as<MeshShape>(shape)) return grid_shape(*mesh);
  return {};
}

bool can_stay_on_device(const ProjectiveSystem& system, const ResidentRun& run) {
  for (const Constraint* constraint : system.constraints) {
    if (constraint->find<FrictionEffect>() != nullptr) continue;
    const auto* contact = constraint->find<ContactEffect>();
    if (contact == nullptr || contact->is_wet() || contact->points().are_embedded()) return false;
    if (!are_known(*run.obstacles)) return false;
  }
  return true;
}

ResidentContact resident_contact(const ProjectiveSystem& system, const ResidentRun& run,
                                 const Eigen::Vector3d& center) {
  ResidentContact result;
  const auto* effect = find_constraint<ContactEffect>(system.constraints);
  if (effect == nullptr) return result;
  const auto* friction = find_constraint<FrictionEffect>(system.constraints);
  const double offset = effect->offset();
  result.rules = {static_cast<float>(offset), static_cast<float>(effect->margin()),
                  static_cast<float>(Opening::kFastest * run.dt),
                  static_cast<float>(ContactDetection::kSafeShare * offset)};
  for (int o = 0; o < static_cast<int>(run.obstacles->size()); ++o) {
    const Obstacle& obstacle = (*run.obstacles)[static_cast<std::size_t>(o)];
    if (obstacle.liquid) continue;
    result.obstacles.push_back(device_obstacle(obstacle, center));
    result.shapes.push_back(obstacle.shape);
    result.numbers.push_back(o);
    Contact with_it;
    with_it.obstacle = o;
    if (friction != nullptr) {
      result.obstacles.back().friction = static_cast<float>(friction->coefficient(with_it));
    }
  }
  return result;
}

void forget_contacts(ProjectiveSystem& system) {
  if (auto* effect = find_constraint<ContactEffect>(system.constraints)) effect->contacts().clear();
}

}  // namespace pliant
