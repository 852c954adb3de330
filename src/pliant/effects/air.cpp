#include "pliant/effects/air.h"

#include <cmath>

#include "pliant/core/body.h"
#include "pliant/effects/contact.h"
#include "pliant/geometry/primitive_shapes.h"

namespace pliant {
namespace {

constexpr int kMaxRootIterations = 60;
constexpr double kRelativeTolerance = 1e-12;

int find_plane(const std::vector<Obstacle>& obstacles) {
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (dynamic_cast<const Plane*>(obstacles[o].shape.get()) != nullptr) return static_cast<int>(o);
  }
  throw InputError("effect 'air' needs an obstacle of shape 'plane' that the cloth lies on");
}

double contact_offset(const Body& body) {
  const auto* contact = dynamic_cast<const ContactEffect*>(body.find_effect("contact"));
  return contact == nullptr ? 0.0 : contact->offset();
}

/// Root of the increasing function `f` in [lo, hi] by the Illinois variant of regula falsi, which
/// never leaves the bracket.
template <class Function>
double root_in(const Function& f, double lo, double f_lo, double hi, double f_hi, double tolerance) {
  for (int k = 0; k < kMaxRootIterations && hi - lo > 0.0; ++k) {
    const double middle = (lo * f_hi - hi * f_lo) / (f_hi - f_lo);
    const double value = f(middle);
    if (std::abs(value) <= tolerance) return middle;
    if (value < 0.0) {
      lo = middle;
      f_lo = value;
      f_hi *= 0.5;
    } else {
      hi = middle;
      f_hi = value;
      f_lo *= 0.5;
    }
  }
  return 0.5 * (lo + hi);
}

}  // namespace

AirEffect::AirEffect(const EffectSite& site, int plane, const Options& options)
    : body_(site.body),
      model_(*site.body.model),
      triangles_(model_.surface_triangles()),
      obstacles_(site.obstacles),
      plane_(plane),
      options_(options),
      edge_(boundary_vertices({model_.particles().x, triangles_})),
      amount_(options.volume) {}

bool AirEffect::edge_is_lifted(const Positions& x) const {
  for (int i : edge_) {
    if (ground_.height(x.col(i)) > options_.seal_gap) return true;
  }
  return false;
}

void AirEffect::begin_step(const Particles& particles, double) {
  const Eigen::Isometry3d& pose = obstacles_[static_cast<std::size_t>(plane_)].pose_end;
  ground_.normal = pose.linear().col(2);
  ground_.level = ground_.normal.dot(pose.translation()) + contact_offset(body_);
  const bool lifted = options_.seal_breaks && edge_is_lifted(particles.x_start);
  // While the edge is off the plane, air goes in and out; what is there when it seals stays.
  if (!lifted && !sealed_) amount_ = std::max(0.0, volume(particles.x_start));
  sealed_ = !lifted;
  if (sealed_) {
    column_volume_gradient(triangles_, particles.x_start, ground_, gradient_);
  }
}

double AirEffect::volume_after(double delta, const Eigen::VectorXd& mobility, const Positions& x) {
  moved_ = x + delta * gradient_ * mobility.asDiagonal();
  return column_volume(triangles_, moved_, ground_);
}

double AirEffect::solve_pressure_change(const Eigen::VectorXd& mobility, const Positions& x) {
  const double pa = options_.atmosphere;
  const double content = pa * amount_;  // p V of the sealed air [J]
  const double scale = pa * model_.particle_areas().sum() * 1e-3 + content;
  const double p0 = pressure();
  // Increasing in delta: pressure and volume both rise with it.
  const auto excess = [&](double delta) {
    return (p0 + delta) * volume_after(delta, mobility, x) - content;
  };
  const double tolerance = kRelativeTolerance * scale;
  double lo = -p0, hi = -gauge_;  // vacuum, and atmospheric pressure
  double f_hi = excess(hi);
  // Flat on the plane without any air, every pressure is a solution; none pulls.
  if (std::abs(f_hi) <= tolerance) return hi;
  double f_lo = -content;
  while (f_hi < 0.0 && hi < 1e12) {
    lo = hi;
    f_lo = f_hi;
    hi += 2.0 * (p0 + hi);
    f_hi = excess(hi);
  }
  if (f_lo >= 0.0) return lo;
  return root_in(excess, lo, f_lo, hi, f_hi, tolerance);
}

void AirEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (!sealed_) return;
  column_volume_gradient(triangles_, x, ground_, gradient_);
  const double delta = solve_pressure_change(mobility, x);
  gauge_ += delta;
  x += delta * gradient_ * mobility.asDiagonal();
}

void AirEffect::add_reactions(std::vector<Reaction>& reactions) const {
  if (!sealed_) return;
  const Positions& x = model_.particles().x;
  const Eigen::Isometry3d& pose = obstacles_[static_cast<std::size_t>(plane_)].pose_end;
  Reaction& reaction = reactions[static_cast<std::size_t>(plane_)];
  for (int i = 0; i < x.cols(); ++i) {
    const Eigen::Vector3d force = -gauge_ * gradient_.col(i);
    reaction.force += force;
    reaction.torque += (x.col(i) - pose.translation()).cross(force);
  }
}

double AirEffect::potential_energy(const Body& body) const {
  const double v = volume(body.particles().x);
  if (!sealed_ || v <= 0.0) return 0.0;
  // Work against the atmosphere less what the isothermal air gives: p_a (V - V_0) - p_a V_0 ln(V/V_0).
  const double expansion = amount_ > 0.0 ? amount_ * std::log(v / amount_) : 0.0;
  return options_.atmosphere * (v - amount_ - expansion);
}

void AirEffect::reset(Body&) {
  amount_ = options_.volume;
  sealed_ = true;
  gauge_ = 0.0;
}

EffectRegistry::Entry air_entry() {
  return {"air",
          "air sealed between a wet cloth and a plane, at constant amount (Boyle's law)",
          {number_parameter("volume", "m^3", "0", 0.0, 1e3,
                            "of the sealed air at atmospheric pressure"),
           positive_parameter("atmosphere", "Pa", "101325", 1e9, "pressure outside"),
           flag_parameter("seal_breaks", "true",
                          "air enters while the cloth's edge is off the plane; false as in the thesis"),
           positive_parameter("seal_gap", "m", "0.002", 1.0,
                              "height of the edge at which the seal breaks")},
          {"cloth"},
          [](const Parameters& parameters, const EffectSite& site) {
            AirEffect::Options options;
            options.volume = parameters.number("volume");
            options.atmosphere = parameters.number("atmosphere");
            options.seal_breaks = parameters.flag("seal_breaks");
            options.seal_gap = parameters.number("seal_gap");
            return std::make_unique<AirEffect>(site, find_plane(site.obstacles), options);
          }};
}

}  // namespace pliant
