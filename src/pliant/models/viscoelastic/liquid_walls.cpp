#include "pliant/models/viscoelastic/liquid_walls.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"
#include "pliant/laws/sph_walls.h"
#include "pliant/models/viscoelastic/liquid.h"

namespace pliant {
namespace {

// Particles of which a thread looks for the walls near them: a shape's distance takes long.
constexpr int kGrain = 128;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// Bound on how far any point within `radius` of the obstacle's origin moves in the step.
double motion_bound(const Obstacle& obstacle, double radius) {
  const Eigen::Isometry3d motion = obstacle.pose_start.inverse() * obstacle.pose_end;
  const double angle = Eigen::AngleAxisd(motion.rotation()).angle();
  return motion.translation().norm() + angle * radius;
}

double most_squared(const Positions& x, const Positions& y) {
  return parallel_reduce(
      0, static_cast<int>(x.cols()), kColumnGrain,
      [&](int begin, int end) {
        const auto apart = x.middleCols(begin, end - begin) - y.middleCols(begin, end - begin);
        return apart.colwise().squaredNorm().maxCoeff();
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

void LiquidWalls::clear() {
  touches_.clear();
  clear_.clear();
}

void LiquidWalls::find(const Positions& x, const std::vector<Obstacle>& obstacles, double support,
                       double dt) {
  const bool fresh = last_.cols() != x.cols() || clear_.size() != obstacles.size();
  if (fresh) {
    clear_.assign(obstacles.size(), std::vector<float>(static_cast<std::size_t>(x.cols()), -1.0f));
  }
  const double moved = fresh || x.cols() == 0 ? 0.0 : std::sqrt(most_squared(x, last_));
  parallel_copy(x, last_);
  touches_.clear();
  open_.setOnes(x.cols());
  if (x.cols() == 0) return;
  const Eigen::AlignedBox3d box = box_of(x);
  for (int o = 0; o < static_cast<int>(obstacles.size()); ++o) {
    const Obstacle& obstacle = obstacles[at(o)];
    const double radius =
        (box.center() - obstacle.pose_end.translation()).norm() + 0.5 * box.diagonal().norm();
    // Of this substep and the last one: poses may have gone on since then.
    const auto nearer = static_cast<float>(1.001 * (moved + 2.0 * motion_bound(obstacle, radius)));
    for_each_column(x, [&](int i) { clear_[at(o)][at(i)] -= nearer; });
    find_with(o, x, obstacle, support, dt);
  }
  for (const Touch& touch : touches_) open_[touch.particle] *= 1.0 - touch.filling;
}

void LiquidWalls::find_with(int obstacle, const Positions& x, const Obstacle& o, double support,
                            double dt) {
  std::vector<float>& clear = clear_[at(obstacle)];
  const SphKernels kernels(support);
  const Eigen::Isometry3d local = o.pose_end.inverse();
  const auto look = [&](int i, std::vector<Touch>& touches) {
    float& safe = clear[at(i)];
    if (safe > 0.0f) return;
    const Eigen::Vector3d p = local * x.col(i);
    const SurfacePoint surface = o.shape->query(p);
    safe = static_cast<float>(surface.distance - support);
    if (surface.distance >= support) return;
    const Eigen::Vector3d on_wall = p - surface.distance * surface.normal;
    const Eigen::Vector3d end = o.pose_end * on_wall;
    touches.push_back({i, obstacle, surface.distance, wall_filling(kernels, surface.distance),
                       o.pose_end.linear() * surface.normal, (end - o.pose_start * on_wall) / dt,
                       x.col(i) - o.pose_end.translation(), Eigen::Vector3d::Zero()});
  };
  // By runs of particles, one after the other.
  const int n = static_cast<int>(x.cols());
  runs_.resize(at((n + kGrain - 1) / kGrain));
  parallel_for(0, static_cast<int>(runs_.size()), 1, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      runs_[at(r)].clear();
      const int last = std::min(n, (r + 1) * kGrain);
      for (int i = r * kGrain; i < last; ++i) look(i, runs_[at(r)]);
    }
  });
  for (const auto& run : runs_) touches_.insert(touches_.end(), run.begin(), run.end());
}

Eigen::Vector3d LiquidWalls::drag(const Touch& touch, const Liquid& liquid,
                                  const SphKernels<double>& kernels,
                                  const Eigen::Vector3d& velocity) {
  const int i = touch.particle;
  const Eigen::Vector3d slip = velocity - touch.velocity;
  const Eigen::Vector3d along = slip - touch.normal * touch.normal.dot(slip);
  return wall_drag(kernels, liquid.volumes()[i], liquid.material(i).viscosity, touch.distance) *
         along;
}

void LiquidWalls::add_losses(const Liquid& liquid, const Particles& particles,
                             const Eigen::VectorXd& beta, double dt,
                             Eigen::VectorXd& losses) const {
  const SphKernels kernels(liquid.support());
  for (const Touch& touch : touches_) {
    const int i = touch.particle;
    if (beta[i] == 0.0) continue;
    const Eigen::Vector3d mean = 0.5 * (particles.v_start.col(i) + particles.v.col(i));
    const Eigen::Vector3d force = beta[i] * drag(touch, liquid, kernels, particles.v_start.col(i));
    losses[i] += dt * force.dot(mean - touch.velocity);
  }
}

void LiquidWalls::add_forces(const Liquid& liquid, const Particles& particles,
                             const Eigen::VectorXd& beta, Forces& f) {
  const SphKernels kernels(liquid.support());
  const auto force_of = [&](const Touch& touch) -> Eigen::Vector3d {
    const int i = touch.particle;
    if (beta[i] == 0.0) return Eigen::Vector3d::Zero();
    const LiquidMaterial& m = liquid.material(i);
    const double psi = liquid.last_filling()[i], volume = liquid.volumes()[i];
    const double others = open_[i] / (1.0 - touch.filling);
    const double push = wall_push(kernels, others * volume, m.bulk(), psi, touch.distance);
    return beta[i] * (push * touch.normal - drag(touch, liquid, kernels, particles.v.col(i)));
  };
  parallel_for(0, static_cast<int>(touches_.size()), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) touches_[at(k)].force = force_of(touches_[at(k)]);
  });
  // A particle may touch several walls.
  for (const Touch& touch : touches_) f.col(touch.particle) += touch.force;
}

void LiquidWalls::add_reactions(std::vector<Reaction>& reactions) const {
  for (const Touch& touch : touches_) {
    Reaction& reaction = reactions[at(touch.obstacle)];
    reaction.force -= touch.force;
    reaction.torque -= touch.arm.cross(touch.force);
  }
}

std::vector<LiquidWalls::Push> LiquidWalls::pushes() const {
  std::vector<Push> pushes;
  for (const Touch& touch : touches_) {
    if (touch.force.isZero(0.0)) continue;
    pushes.push_back({touch.particle, touch.obstacle, touch.normal, touch.arm, touch.force});
  }
  return pushes;
}

}  // namespace pliant
