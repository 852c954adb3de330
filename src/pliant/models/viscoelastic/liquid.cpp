#include "pliant/models/viscoelastic/liquid.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/step/step_report.h"
#include "pliant/laws/sph_pairs.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

constexpr int kGrain = 256;
// Support over particle spacing: 33 neighbours.
constexpr double kSupport = 2.0;
// Lists reach so much further than the support, to last for some steps.
constexpr double kSkin = 0.1;
// Shares of H/c and of H²/ν. Symplectic Euler steps are stable up to 2/ω, and the stiffest mode of
// a pair lattice has ω = 4.2 c/H; viscous ones are up to 2/λ, with λ below 27 ν/H² by Gershgorin.
constexpr double kCourant = 0.4;
constexpr double kViscous = 0.07;

/// ψ of a kernel sum.

std::size_t at(int k) { return static_cast<std::size_t>(k); }

}  // namespace

void Liquid::add_part(const Eigen::VectorXd& volumes, const LiquidMaterial& material) {
  const Eigen::Index before = volumes_.size();
  volumes_.conservativeResize(before + volumes.size());
  volumes_.tail(volumes.size()) = volumes;
  parts_.resize(at(size()), static_cast<int>(materials_.size()));
  materials_.push_back(material);
  if (size() > 0) support_ = kSupport * std::cbrt(volumes_.maxCoeff());
  listed_.resize(3, 0);
}

double Liquid::fastest_sound() const {
  double fastest = 0.0;
  for (const LiquidMaterial& material : materials_) {
    fastest = std::max(fastest, material.sound_speed);
  }
  return fastest;
}

double Liquid::viscous_step() const {
  double thickest = 0.0;
  for (const LiquidMaterial& material : materials_) {
    thickest = std::max(thickest, material.viscosity / material.density);
  }
  return kViscous * support_ * support_ / std::max(thickest, 1e-300);
}

double Liquid::stable_step(double speed) const {
  return std::min(kCourant * support_ / (fastest_sound() + speed), viscous_step());
}

double Liquid::stable_speed(double dt) const { return kCourant * support_ / dt - fastest_sound(); }

bool Liquid::acts(const Eigen::VectorXd& beta) const {
  return materials_.size() > 1 || (beta.size() > 0 && beta.maxCoeff() > 0.0);
}

void Liquid::list_at(const Positions& x) {
  listed_ = x;
  lists_.build(x, (1.0 + kSkin) * support_);
}

const NeighborLists& Liquid::neighbors(const Positions& x) {
  const double slack = 0.5 * kSkin * support_;
  const bool holds = listed_.cols() == x.cols() && x.cols() > 0 &&
                     (x - listed_).colwise().squaredNorm().maxCoeff() < slack * slack;
  if (!holds) list_at(x);
  return lists_;
}

void Liquid::gather(const Positions& x, const Eigen::Matrix3Xd& v, const Eigen::VectorXd& beta) {
  const std::vector<int>& order = lists_.order();
  ranked_.resize(order.size());
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const int i = order[at(k)];
      LiquidParticle& own = ranked_[at(k)];
      for (int axis = 0; axis < 3; ++axis) {
        own.x[axis] = x(axis, i);
        own.v[axis] = v(axis, i);
      }
      own.volume = volumes_[i];
      own.pressure = 0.0;
      own.viscosity = material(i).viscosity;
      own.beta = beta[i];
      own.part = parts_[at(i)];
      own.none = 0.0;
    }
  });
}

void Liquid::fill(const LiquidWalls* walls) {
  const LiquidSums sums = {lists_, ranked_.data(), SphKernels(support_)};
  psi_.resize(size());
  sums_.resize(size());
  parallel_for(0, size(), kGrain, [&](int begin, int end) { sums.fill(begin, end, sums_.data()); });
  // Pressures are read by others' pushes only.
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const int i = lists_.order()[at(k)];
      const double psi = sph_filling(sums_[k] + (walls ? walls->filling(i) : 0.0));
      const LiquidMaterial& m = material(i);
      psi_[i] = psi;
      ranked_[at(k)].pressure = sph_pressure(m.bulk(), psi);
    }
  });
}

void Liquid::push(Forces& f) {
  const LiquidSums sums = {lists_, ranked_.data(), SphKernels(support_)};
  pushes_.resize(3, size());
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    sums.push(begin, end, pushes_.data());
    for (int k = begin; k < end; ++k) f.col(lists_.order()[at(k)]) += pushes_.col(k);
  });
}

void Liquid::device_failed(const std::string& reason) {
  device_.reset();
  device_failure_ = reason;
}

bool Liquid::add_device_forces(const Particles& particles, const Eigen::VectorXd& beta,
                               const LiquidWalls* walls, Forces& f, StepReport& report) {
  ScopedPhase phase(report, "liquid");
  wall_filling_.resize(0);
  if (walls != nullptr && walls->any()) {
    wall_filling_.resize(size());
    parallel_for(0, size(), kGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) wall_filling_[i] = static_cast<float>(walls->filling(i));
    });
  }
  try {
    device_->add_forces(state(particles, beta), wall_filling_, psi_, f);
  } catch (const DeviceFailure& failure) {
    device_failed(failure.what());
    return false;
  }
  return true;
}

void Liquid::add_forces(const Particles& particles, const Eigen::VectorXd& beta, LiquidWalls* walls,
                        Forces& f, StepReport& report) {
  if (device_ && add_device_forces(particles, beta, walls, f, report)) {
    if (walls) walls->add_forces(*this, particles, beta, f);
    return;
  }
  if (!device_failure_.empty()) {
    report.warn("liquid_cpu: not on the GPU, but on the CPU: " +
                std::exchange(device_failure_, {}));
  }
  {
    ScopedPhase phase(report, "neighbors");
    neighbors(particles.x);
  }
  {
    ScopedPhase phase(report, "density");
    gather(particles.x, particles.v, beta);
    fill(walls);
  }
  ScopedPhase phase(report, "pressure");
  push(f);
  if (walls) walls->add_forces(*this, particles, beta, f);
}

double Liquid::compressed_share(const Eigen::VectorXd& beta) const {
  constexpr double kCompressed = 1.25, kLiquid = 0.5;
  int liquid = 0, compressed = 0;
  for (int i = 0; i < psi_.size(); ++i) {
    if (beta[i] <= kLiquid) continue;
    ++liquid;
    compressed += psi_[i] > kCompressed ? 1 : 0;
  }
  return liquid > 0 ? static_cast<double>(compressed) / liquid : 0.0;
}

Eigen::VectorXd Liquid::filling(const Positions& x) const {
  NeighborLists lists;
  lists.build(x, support_);
  const SphKernels kernels(support_);
  Eigen::VectorXd result(size());
  for (int k = 0; k < size(); ++k) {
    const int i = lists.order()[at(k)];
    double sum = volumes_[i] * kernels.spiky(0.0);
    for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
      const int o = lists.order()[at(*j)];
      sum += volumes_[o] * kernels.spiky((x.col(i) - x.col(o)).norm());
    }
    result[i] = sph_filling(sum);
  }
  return result;
}

}  // namespace pliant
