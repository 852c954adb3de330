#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "cuda/models/viscoelastic/device_liquid.h"
#include "cuda/models/viscoelastic/wall_sums.h"
#include "cuda/solvers/cluster_relaxation.h"
#include "cuda/solvers/device_step.h"
#include "pliant/math/error.h"
#include "pliant/models/viscoelastic/blended_system.h"
#include "pliant/solvers/chebyshev.h"

namespace pliant {

/// x + h v + h² f / m, in quanta; the prediction's M/h² is there already.
struct PredictBlend {
  const Fixed* x;        ///< by place
  Float4* motion;        ///< v, becomes that of the prediction
  const Float4* forces;  ///< null: none [N]
  const float* mobility;
  Fixed *predicted, *start;
  Float3 gravity;
  float dt, quantum;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    Fixed y = x[i];
    y.w = predicted[i].w;
    if (mobility[i] > 0.0f) {
      // h f/m = f / (h M/h²).
      Float3 v = motion[i].xyz() + dt * gravity;
      if (forces != nullptr) v += (1.0f / (dt * y.w)) * forces[i].xyz();
      y = moved(y, (dt / quantum) * v);
      motion[i] = with_w(v, motion[i].w);
    }
    predicted[i] = start[i] = y;
  }
};

/// To where the iterations end: the way from the prediction changes the velocity.
struct FinishBlend {
  const Fixed* predicted;
  const Float4* way;  ///< [m]
  Fixed* x;
  Float4* motion;
  float dt, quantum;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Float3 u = way[i].xyz();
    const Fixed to = moved(predicted[i], (1.0f / quantum) * u);
    x[i] = {to.x, to.y, to.z, x[i].w};
    const Float3 v = motion[i].xyz() + (1.0f / dt) * u;
    motion[i] = with_w(v, motion[i].w);
  }
};

/// Particles between solid and liquid whose state stays in the memory of an executor: whole steps
/// of SPH between half spaces, gravity, Chebyshev iterations on the clusters and the blend of both,
/// as ViscoelasticModel and `chebyshev` take them, with nothing copied but what is asked for.
/// beta, clusters and the time step stay as they are.
template <class Executor>
class ResidentBlend {
 public:
  struct Options {
    double dt = 1e-3;  ///< no longer than Liquid::stable_step() [s]
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s²]
    int iterations = 20;
    int delay = 5;
    std::vector<Eigen::Vector4d> walls;  ///< normal n and d of half spaces n·x < d
    int threads_per_particle = 1;
  };

  /// Throws InputError for a system that has no device form.
  ResidentBlend(const BlendedSystem& system, const Options& options)
      : options_(options),
        packed_(pack(system, system.particles.size() >= kLarge ? 128 : 64)),
        step_(packed_, options.threads_per_particle) {
    if (options.walls.size() > static_cast<std::size_t>(kMostWalls)) {
      throw InputError("more walls than a GPU takes");
    }
    flows_ = system.liquid.acts(system.beta);
    place(system);
    set_rules(system);
    upload(system);
  }

  void step() {
    if (flows_) push_liquid();
    predict();
    iterate();
    finish();
  }
  // The parts of a step, for those who time them.
  void push_liquid() {
    if (!liquid_) liquid_ = executor().capture([this] { launch_liquid(); });
    executor().replay(liquid_);
  }
  void predict();
  void iterate() { step_.run(options_.iterations); }
  void finish();

  Executor& executor() { return step_.executor(); }
  const PackedSystem& packed() const { return packed_; }
  StepControl control() { return step_.control().front(); }
  void download(Positions& x, Positions& v);

 private:
  static constexpr int kLarge = 40000;                 // as DeviceSolver
  static constexpr double kQuantum = 1.0 / (1 << 27);  // of the body's reach: it may spread
  template <class T>
  using Array = typename Executor::template Array<T>;

  void place(const BlendedSystem& system);
  void set_rules(const BlendedSystem& system);
  void launch_liquid();
  void upload(const BlendedSystem& system);
  float dt() const { return static_cast<float>(options_.dt); }
  float quantum() const { return static_cast<float>(quantum_); }

  Options options_;
  PackedSystem packed_;
  DeviceStep<Executor> step_;
  LiquidPasses<Executor> passes_;
  typename Executor::Graph liquid_;
  bool flows_ = false, has_parts_ = false;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double quantum_ = 1.0;  // [m]
  float support_ = 1.0f;
  HalfSpaces walls_;
  Array<Fixed> x_;
  Array<Float4> motion_, forces_;
  Array<int> parts_;
  Array<float> mobility_, filled_, filling_;
};

template <class Executor>
void ResidentBlend<Executor>::place(const BlendedSystem& system) {
  const Positions& x = system.particles.x;
  const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  center_ = 0.5 * (low + high);
  const Eigen::Vector3d extent = high - low;
  quantum_ = std::max(kQuantum * 0.5 * extent.maxCoeff(), 1e-30);
  support_ = static_cast<float>(system.liquid.support());
  for (const Eigen::Vector4d& wall : options_.walls) {
    const Eigen::Vector3d normal = wall.head<3>().normalized();
    const double level = wall[3] / wall.head<3>().norm() - normal.dot(center_);
    walls_.planes[walls_.count++] = {static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                                     static_cast<float>(normal[2]), static_cast<float>(level)};
  }
  std::vector<LiquidMaterial> materials;
  for (int i = 0; i < system.liquid.size(); ++i) {
    const auto part = static_cast<std::size_t>(system.liquid.parts()[static_cast<std::size_t>(i)]);
    if (part >= materials.size()) materials.resize(part + 1, system.liquid.material(i));
  }
  has_parts_ = materials.size() > 1;
  passes_.shape(executor(), system.particles.size(), extent.data(), system.liquid.support(),
                quantum_, liquid_constants(materials));
}

template <class Executor>
void ResidentBlend<Executor>::set_rules(const BlendedSystem& system) {
  const Particles& particles = system.particles;
  ClusterRelaxation known;
  if (!known.set(system, options_.dt)) throw InputError("elements that are no clusters");
  const Relaxation& relaxation = known.relaxation;
  const auto n = static_cast<std::size_t>(particles.size());
  std::vector<float> mobility(n);
  std::vector<Fixed> inertia(n);
  double ratio = 1.0;
  for (std::size_t k = 0; k < n; ++k) {
    const int i = packed_.order[k];
    const double own = particles.mass[i] / (options_.dt * options_.dt);
    mobility[k] = static_cast<float>(relaxation.mobility[i]);
    inertia[k] = {0, 0, 0, static_cast<float>(own)};
    if (!particles.is_fixed(i)) ratio = std::max(ratio, known.diagonal[i] / own);
  }
  step_.set_mobility(mobility);
  step_.set_predicted(inertia);
  step_.set_contacts(ContactTable());
  mobility_.resize(n);
  executor().upload(mobility_, mobility.data(), n);
  StepRules rules;
  rules.quantum = quantum();
  rules.gamma = relaxation.gamma;
  rules.careful = std::min(1.0, 1.0 / (relaxation.gamma * relaxation.largest_eigenvalue));
  rules.is_accelerated = true;
  rules.may_raise = true;
  rules.rho_bound =
      ChebyshevSolver::largest_radius(relaxation, ratio, options_.iterations, options_.delay);
  rules.rho = rules.rho_bound;
  const double unit = std::sqrt(known.diagonal.sum()) * quantum_;
  rules.round_off = 0.01 * unit;
  rules.noise = 8.0 * unit;
  rules.delay = options_.delay;
  step_.set_rules({rules});
}

template <class Executor>
void ResidentBlend<Executor>::upload(const BlendedSystem& system) {
  const Particles& p = system.particles;
  const auto n = static_cast<std::size_t>(p.size());
  std::vector<Fixed> x(n);
  std::vector<Float4> motion(n);
  std::vector<int> parts(n);
  const double cubed = std::pow(system.liquid.support(), 3);
  for (std::size_t k = 0; k < n; ++k) {
    const int i = packed_.order[k];
    const Eigen::Vector3d at = (p.x.col(i) - center_) / quantum_;
    const auto whole = [&](int axis) { return static_cast<int>(std::lrint(at[axis])); };
    x[k] = {whole(0), whole(1), whole(2), static_cast<float>(system.liquid.volumes()[i] / cubed)};
    const Eigen::Vector3f v = p.v.col(i).cast<float>();
    motion[k] = {v[0], v[1], v[2], static_cast<float>(system.beta[i])};
    parts[k] = system.liquid.parts()[static_cast<std::size_t>(i)];
  }
  x_.resize(n);
  motion_.resize(n);
  parts_.resize(n);
  forces_.resize(n);
  filled_.resize(n);
  filling_.resize(n);
  executor().upload(x_, x.data(), n);
  executor().upload(motion_, motion.data(), n);
  executor().upload(parts_, parts.data(), n);
  executor().synchronize();
}

template <class Executor>
void ResidentBlend<Executor>::launch_liquid() {
  const int n = packed_.particles;
  const bool has_walls = walls_.count > 0;
  const int* parts = has_parts_ ? parts_.data() : nullptr;
  if (has_walls) {
    executor().launch(n, FillWalls{walls_, x_.data(), quantum(), support_, filled_.data()});
  }
  passes_.run(executor(), x_.data(), motion_.data(), parts, has_walls ? filled_.data() : nullptr,
              filling_.data(), forces_.data());
  if (has_walls) {
    executor().launch(
        n, PushWalls{walls_, x_.data(), motion_.data(), parts, passes_.constants(), filled_.data(),
                     filling_.data(), quantum(), support_, forces_.data()});
  }
}

template <class Executor>
void ResidentBlend<Executor>::predict() {
  const Eigen::Vector3f g(options_.gravity.template cast<float>());
  executor().launch(packed_.particles, PredictBlend{x_.data(),
                                                    motion_.data(),
                                                    flows_ ? forces_.data() : nullptr,
                                                    mobility_.data(),
                                                    step_.predicted(),
                                                    step_.start(),
                                                    {g[0], g[1], g[2]},
                                                    dt(),
                                                    quantum()});
}

template <class Executor>
void ResidentBlend<Executor>::finish() {
  executor().launch(packed_.particles, FinishBlend{step_.predicted(), step_.result(), x_.data(),
                                                   motion_.data(), dt(), quantum()});
}

template <class Executor>
void ResidentBlend<Executor>::download(Positions& x, Positions& v) {
  const auto n = static_cast<std::size_t>(packed_.particles);
  std::vector<Fixed> places(n);
  std::vector<Float4> motion(n);
  executor().download(places.data(), x_, n);
  executor().download(motion.data(), motion_, n);
  x.resize(3, packed_.particles);
  v.resize(3, packed_.particles);
  for (std::size_t k = 0; k < n; ++k) {
    const int i = packed_.order[k];
    x.col(i) = center_ + quantum_ * Eigen::Vector3d(places[k].x, places[k].y, places[k].z);
    v.col(i) = Eigen::Vector3d(motion[k].x, motion[k].y, motion[k].z);
  }
}

}  // namespace pliant
