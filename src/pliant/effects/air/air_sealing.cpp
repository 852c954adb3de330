#include "pliant/effects/air/air_sealing.h"

#include <algorithm>
#include <sstream>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

bool is_plane(const Obstacle& obstacle) { return as<Plane>(*obstacle.shape) != nullptr; }

/// What cloth is sealed on where the scene does not say it.
std::vector<int> likely_obstacles(const std::vector<Obstacle>& obstacles) {
  std::vector<int> own;
  for (int o = 0; o < static_cast<int>(obstacles.size()); ++o) {
    const Obstacle& obstacle = obstacles[static_cast<std::size_t>(o)];
    if (obstacle.liquid || !obstacle.link.empty()) continue;
    if (is_plane(obstacle)) return {o};
    own.push_back(o);
  }
  return own;
}

/// The obstacles, or all of the robot links, that `names` lists.
std::vector<int> named_obstacles(const std::string& names, const std::vector<Obstacle>& obstacles) {
  std::vector<int> chosen;
  std::stringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    name.erase(0, name.find_first_not_of(' '));
    name.erase(name.find_last_not_of(' ') + 1);
    const std::size_t before = chosen.size();
    std::vector<std::string> known = {"auto"};
    for (int o = 0; o < static_cast<int>(obstacles.size()); ++o) {
      const Obstacle& obstacle = obstacles[static_cast<std::size_t>(o)];
      const std::string& own = obstacle.link.empty() ? obstacle.name : obstacle.link;
      if (own == name && !obstacle.liquid) chosen.push_back(o);
      if (std::find(known.begin(), known.end(), own) == known.end()) known.push_back(own);
    }
    if (chosen.size() == before) {
      throw InputError("effect 'air': obstacles: " +
                       unknown_name_message("solid obstacle or robot link", name, known));
    }
  }
  return chosen;
}

}  // namespace

std::vector<int> sealing_obstacles(const std::string& names,
                                   const std::vector<Obstacle>& obstacles) {
  std::vector<int> chosen =
      names == "auto" ? likely_obstacles(obstacles) : named_obstacles(names, obstacles);
  if (chosen.empty()) {
    throw InputError(
        "effect 'air' needs an obstacle that the cloth lies on: add one to obstacles, or name "
        "robot links by its parameter `obstacles`");
  }
  return chosen;
}

Eigen::Matrix3Xi triangles_above(const Model& model, const FootFinder& finder) {
  const Positions& x = model.particles().x;
  Eigen::Matrix3Xi triangles = model.surface_triangles();
  FootPoints foot_points;
  finder.find(x, 0.0, foot_points);
  double facing = 0.0;
  for (const auto t : triangles.colwise()) {
    const Eigen::Vector3d area = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0]));
    for (int k = 0; k < 3; ++k) facing += area.dot(foot_points.normal(t[k]));
  }
  if (facing < 0.0) triangles.row(1).swap(triangles.row(2));
  return triangles;
}

}  // namespace pliant
