#include "pliant/effects/air.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/body.h"
#include "pliant/effects/contact.h"
#include "pliant/geometry/primitive_shapes.h"

namespace pliant {
namespace {

constexpr int kMaxRootIterations = 60;
constexpr double kRelativeTolerance = 1e-10;
// Height of a bubble below which its volume counts as none [m].
constexpr double kTinyHeight = 1e-6;
// Share of the mesh width by which one relaxation may move a particle: beyond it the gradient of
// the volume says nothing any more.
constexpr double kLargestMove = 0.25;
// Of the atmosphere's pressure: below it a vacuum's stiffness counts as this one's.
constexpr double kTinyShare = 1e-6;
const char* const kLimitedWarning =
    "air_limited: the air would move vertices further than a quarter of the mesh width per "
    "iteration; "
    "its pressure is not converged: take a smaller time step, more iterations or a stiffer cloth";

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

struct Sample {
  double value;
  double slope;  // an estimate that is right near the root is enough
};

/// Root of the increasing function `f` above `lo`, by Newton steps from 0 kept inside the bracket
/// that the signs seen so far leave; `lo` itself when f is positive throughout.
template <class Function>
double root_above(const Function& f, double lo, double tolerance) {
  const double reach = std::abs(lo);
  double hi = std::numeric_limits<double>::infinity();
  double at = 0.0;
  for (int k = 0; k < kMaxRootIterations; ++k) {
    const Sample sample = f(at);
    if (std::abs(sample.value) <= tolerance) break;
    (sample.value < 0.0 ? lo : hi) = at;
    double next = sample.slope > 0.0 ? at - sample.value / sample.slope : lo;
    // Where the slope misleads: a bounded step while there is no upper end, then halving, which
    // comes every few steps anyway to bound the work.
    const double furthest = at + reach;
    const bool misled = !(next > lo && next < hi && next <= furthest) || k % 8 == 7;
    if (misled) next = std::isinf(hi) ? furthest : 0.5 * (lo + hi);
    if (next == at) break;
    at = next;
  }
  return at;
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
      conductance_(options.permeability * model_.particle_areas().sum()),
      largest_move_(kLargestMove * std::sqrt(model_.particle_areas().mean())),
      gradient_(Eigen::Matrix3Xd::Zero(3, model_.particles().size())),
      moved_(model_.particles().x) {
  start_filling();
}

void AirEffect::start_filling() {
  filled_ = options_.fill_time > 0.0 ? 0.0 : 1.0;
  amount_ = filled_ * options_.volume;
}

void AirEffect::let_in(double dt) {
  if (filled_ == 1.0) return;
  const double share = std::min(1.0 - filled_, dt / options_.fill_time);
  amount_ += share * options_.volume;
  filled_ += share;
}

Ground AirEffect::ground() const {
  const Eigen::Isometry3d& pose = obstacles_[static_cast<std::size_t>(plane_)].pose_end;
  const Eigen::Vector3d normal = pose.linear().col(2);
  return {normal, normal.dot(pose.translation()) + contact_offset(body_)};
}

bool AirEffect::edge_is_lifted(const Positions& x) const {
  for (int i : edge_) {
    if (ground_.height(x.col(i)) > options_.seal_gap) return true;
  }
  return false;
}

void AirEffect::begin_step(const Particles& particles, double dt) {
  dt_ = dt;
  limited_ = false;
  ground_ = ground();
  const bool lifted = options_.seal_breaks && edge_is_lifted(particles.x_start);
  // While the edge is off the plane, air goes in and out; what is there when it seals stays.
  if (!lifted && !sealed_) amount_ = std::max(0.0, enclosed_volume(particles.x_start));
  sealed_ = !lifted;
}

void AirEffect::move(double delta, const Eigen::VectorXd& mobility, const Positions& x) {
  for (int i = 0; i < x.cols(); ++i) {
    moved_.col(i) = x.col(i) + delta * mobility[i] * gradient_.col(i);
  }
}

double AirEffect::enclosed_volume(const Positions& x) {
  heights_above(x, ground_, heights_);
  return column_volume(triangles_, x, heights_, ground_.normal);
}

double AirEffect::volume_slope(const Eigen::VectorXd& mobility) const {
  double slope = 0.0;
  for (int i = 0; i < heights_.size(); ++i) {
    if (heights_[i] > 0.0) slope += mobility[i] * gradient_.col(i).squaredNorm();
  }
  return slope;
}

double AirEffect::solve_pressure_change(const Eigen::VectorXd& mobility, const Positions& x) {
  const double pa = options_.atmosphere;
  const double content = pa * amount_;  // p V of the sealed air [J]
  const double leak = pa * dt_ * conductance_;
  // Boyle with Darcy's inflow, p V = p_a V_0 + p_a h Γ (p_a - p); increasing in the pressure.
  const auto excess = [&](double delta) -> Sample {
    move(delta, mobility, x);
    const double gauge = gauge_ + delta;
    const double v = enclosed_volume(moved_);
    return {(pa + gauge) * v - content + leak * gauge,
            v + leak + (pa + gauge) * volume_slope(mobility)};
  };
  const double vacuum = -pressure();
  const double scale = pa * model_.particle_areas().sum() * kTinyHeight + content;
  return root_above(excess, vacuum, kRelativeTolerance * scale);
}

double AirEffect::largest_change(const Eigen::VectorXd& mobility) const {
  double fastest = 0.0;  // displacement per pressure [m/Pa]
  const Positions& x = body_.particles().x;
  for (int i = 0; i < gradient_.cols(); ++i) {
    // A particle that lies on the ground is stopped by it.
    if (ground_.height(x.col(i)) == 0.0) continue;
    fastest = std::max(fastest, mobility[i] * gradient_.col(i).norm());
  }
  return fastest > 0.0 ? largest_move_ / fastest : std::numeric_limits<double>::infinity();
}

void AirEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (!sealed_) return;
  column_volume_gradient(triangles_, x, ground_, gradient_);
  const double wanted = solve_pressure_change(mobility, x);
  const double largest = largest_change(mobility);
  const double delta = std::clamp(wanted, -largest, largest);
  limited_ = delta != wanted;
  gauge_ += delta;
  move(delta, mobility, x);
  x.swap(moved_);
}

void AirEffect::add_forces(Forces& f) const {
  // Without a pressure the gradient may be one of a step that was undone.
  if (sealed_ && gauge_ != 0.0) f += gauge_ * gradient_;
}

void AirEffect::add_rows(const Positions& x, CouplingRows& rows) {
  if (!sealed_) return;
  // Boyle with leak, p V = const + leak: dp = -(p/V') dV with V' = V + p_a h Γ.
  const double v = std::max(enclosed_volume(x), 0.0) + options_.atmosphere * dt_ * conductance_;
  rows.begin_row(0.0, v / std::max(pressure(), kTinyShare * options_.atmosphere));
  for (int i = 0; i < gradient_.cols(); ++i) {
    if (!gradient_.col(i).isZero(0.0)) rows.add(i, gradient_.col(i));
  }
}

void AirEffect::report(StepReport& report) const {
  if (sealed_ && limited_) report.warn(kLimitedWarning);
}

void AirEffect::after_step(Body&, double dt) {
  if (sealed_) amount_ = std::max(0.0, amount_ - dt * conductance_ * gauge_);
  let_in(dt);
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
  // Work against the atmosphere less what the isothermal air gives: p_a (V - V_0) - p_a V_0
  // ln(V/V_0).
  const double expansion = amount_ > 0.0 ? amount_ * std::log(v / amount_) : 0.0;
  return options_.atmosphere * (v - amount_ - expansion);
}

void AirEffect::reset(Body&) {
  start_filling();
  sealed_ = true;
  gauge_ = 0.0;
}

void AirEffect::save(SavedNumbers& numbers) const {
  for (double number : {amount_, filled_, sealed_ ? 1.0 : 0.0, gauge_}) numbers.write(number);
}

void AirEffect::load(SavedNumbers& numbers) {
  amount_ = numbers.read();
  filled_ = numbers.read();
  sealed_ = numbers.read() == 1.0;
  gauge_ = numbers.read();
}

EffectRegistry::Entry air_entry() {
  return {
      "air",
      "air sealed between a wet cloth and a plane, at constant amount (Boyle's law)",
      {number_parameter("volume", "m^3", "0", 0.0, 1e3,
                        "of the sealed air at atmospheric pressure"),
       number_parameter("fill_time", "s", "0", 0.0, 1e6,
                        "over which the air is let in: a cloth that starts flat is inflated then, "
                        "not thrown up; 0: it is there at once"),
       positive_parameter("atmosphere", "Pa", "101325", 1e9, "pressure outside"),
       number_parameter("permeability", "m/(s Pa)", "0", 0.0, 1.0,
                        "of the weave: air flow per area and pressure difference"),
       flag_parameter("seal_breaks", "true",
                      "air enters while the cloth's edge is off the plane; false as in the thesis"),
       positive_parameter("seal_gap", "m", "0.002", 1.0,
                          "height of the edge at which the seal breaks")},
      {"cloth"},
      [](const Parameters& parameters, const EffectSite& site) {
        AirEffect::Options options;
        options.volume = parameters.number("volume");
        options.fill_time = parameters.number("fill_time");
        options.atmosphere = parameters.number("atmosphere");
        options.permeability = parameters.number("permeability");
        options.seal_breaks = parameters.flag("seal_breaks");
        options.seal_gap = parameters.number("seal_gap");
        return std::make_unique<AirEffect>(site, find_plane(site.obstacles), options);
      }};
}

}  // namespace pliant
