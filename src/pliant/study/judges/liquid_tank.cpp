#include "pliant/study/judges/liquid_tank.h"

#include <algorithm>
#include <stdexcept>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

constexpr double kThick = 0.2, kHigh = 4.0;  // of walls [m]
constexpr int kEndWall = 4;                  // among the obstacles

ViscoelasticModel::Material water(const LiquidTank::Options& options) {
  ViscoelasticModel::Material material;
  material.beta = 1.0;
  material.liquid = {1000.0, options.sound_speed, options.viscosity};
  return material;
}

void add_box(World& world, const Eigen::AlignedBox3d& box) {
  Obstacle obstacle;
  obstacle.name = "wall";
  obstacle.shape = std::make_shared<Box>(box.sizes());
  obstacle.pose_start = obstacle.pose_end = Eigen::Isometry3d(Eigen::Translation3d(box.center()));
  world.add_obstacle(std::move(obstacle));
}

}  // namespace

LiquidTank::LiquidTank(const Options& options)
    : options_(options),
      scene_(lattice_body(options.counts, options.spacing), water(options), options.time_step) {
  const double width = options.spacing * options.counts.y(), end = options.length;
  const auto add = [&](double x0, double y0, double z0, double x1, double y1, double z1) {
    add_box(scene_.world(), {Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1)});
  };
  add(-kThick, -kThick, -kThick, end + kThick, width + kThick, 0.0);
  add(-kThick, -kThick, 0.0, 0.0, width + kThick, kHigh);
  add(-kThick, -kThick, 0.0, end + kThick, 0.0, kHigh);
  add(-kThick, width, 0.0, end + kThick, width + kThick, kHigh);
  if (options.is_closed) add(end, -kThick, 0.0, end + kThick, width + kThick, kHigh);
  const double gate = options.spacing * options.counts.x();
  if (options.has_gate) add(gate, -kThick, 0.0, gate + kThick, width + kThick, kHigh);
  scene_.add_effect("gravity");
  scene_.add_effect("contact", {{"thickness", std::to_string(0.2 * options.spacing)}});
  scene_.start("jacobi", {{"iterations", "20"}, {"tolerance", "1e-6"}});
}

void LiquidTank::step() {
  if (!scene_.world().step()) throw std::runtime_error(scene_.world().failure());
}

void LiquidTank::release() {
  // Sound passes through the column ten times; each step takes a fifth of the speed that is left.
  const double depth = options_.spacing * options_.counts.z();
  const double rest = 10.0 * depth / options_.sound_speed;
  while (world().time() < rest) {
    step();
    particles().v *= 0.8;
  }
  Obstacle& gate = world().obstacles().back();
  gate.pose_start.translation().z() = gate.pose_end.translation().z() = 1e3;
  released_ = world().time();
}

double LiquidTank::front() { return particles().x.row(0).maxCoeff() + 0.5 * options_.spacing; }

double LiquidTank::height_at_wall(double width) {
  double height = 0.0;
  for (const auto x : particles().x.colwise()) {
    if (x.x() < width) height = std::max(height, x.z() + 0.5 * options_.spacing);
  }
  return height;
}

double LiquidTank::pressure(int particle) {
  const double c = options_.sound_speed;
  const double filling = scene_.model().system().liquid.last_filling()[particle];
  return std::max(0.0, c * c * 1000.0 * (filling - 1.0));
}

double LiquidTank::pressure_on_end(double low, double high) {
  double sum = 0.0;
  for (const LiquidWalls::Push& push : scene_.model().wall_pushes()) {
    const double z = particles().x(2, push.particle);
    if (push.obstacle == kEndWall && low <= z && z < high) sum -= push.force.x();
  }
  return sum / ((high - low) * options_.spacing * options_.counts.y());
}

}  // namespace pliant
