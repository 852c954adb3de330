#include "pliant/effects/air.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/effects/contact.h"
#include "pliant/effects/wetness.h"
#include "pliant/geometry/primitive_shapes.h"
#include "pliant/math/error.h"

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
// Ratio of the specific heats of air.
constexpr double kAdiabatic = 1.4;
const char* const kLimitedWarning =
    "air_limited: the air would move vertices further than a quarter of the mesh width per "
    "iteration; "
    "its pressure is not converged: take a smaller time step, more iterations or a stiffer cloth";
const char* const kPassedWarning =
    "air_negative_volume: cloth over a bubble passed through itself or what it lies on, and has "
    "nothing below it there; add self_contact and contact, or take a smaller time step";

bool is_plane(const Obstacle& obstacle) {
  return dynamic_cast<const Plane*>(obstacle.shape.get()) != nullptr;
}

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

std::vector<int> sealing_obstacles(const std::string& names,
                                   const std::vector<Obstacle>& obstacles) {
  std::vector<int> chosen =
      names == "auto" ? likely_obstacles(obstacles) : named_obstacles(names, obstacles);
  if (chosen.empty()) {
    throw InputError(
        "effect 'air' needs an obstacle that the cloth lies on: add one to obstacles, or name "
        "robot "
        "links by its parameter `obstacles`");
  }
  return chosen;
}

/// The triangles of a cloth, wound so that it has its air below.
Eigen::Matrix3Xi outward(const Model& model, const FootFinder& finder) {
  const Positions& x = model.particles().x;
  Eigen::Matrix3Xi triangles = model.surface_triangles();
  Feet feet;
  finder.find(x, 0.0, feet);
  double facing = 0.0;
  for (const auto t : triangles.colwise()) {
    const Eigen::Vector3d area = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0]));
    for (int k = 0; k < 3; ++k) facing += area.dot(feet.normal(t[k]));
  }
  if (facing < 0.0) triangles.row(1).swap(triangles.row(2));
  return triangles;
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

AirEffect::AirEffect(const EffectSite& site, std::vector<int> sealing, const Options& options)
    : body_(site.body),
      model_(*site.body.model),
      obstacles_(site.obstacles),
      finder_(site.obstacles, std::move(sealing)),
      options_(options),
      triangles_(outward(model_, finder_)),
      bubbles_(model_.particles().x, triangles_),
      largest_move_(kLargestMove * std::sqrt(model_.particle_areas().mean())) {
  start_filling();
}

void AirEffect::start_filling() {
  filled_ = options_.fill_time > 0.0 ? 0.0 : 1.0;
  loose_ = filled_ * options_.volume;
}

void AirEffect::let_in(double dt) {
  if (filled_ == 1.0) return;
  const double share = std::min(1.0 - filled_, dt / options_.fill_time);
  loose_ += share * options_.volume;
  filled_ += share;
}

double AirEffect::offset() const { return contact_offset(body_); }

void AirEffect::begin_step(const Particles& particles, double dt) {
  dt_ = dt;
  wetness_ = dynamic_cast<const WetnessEffect*>(body_.find_effect("wetness"));
  finder_.find(particles.x_start, offset(), feet_);
  const double gap =
      options_.seal_breaks ? options_.seal_gap : std::numeric_limits<double>::infinity();
  bubbles_.follow(feet_.heights, gap, loose_, [&](Bubble& bubble) {
    gather(particles.x_start, bubble);
    return trapped_volume(bubble.triangles, bubble.x, bubble.feet);
  });
  for (Bubble& bubble : bubbles_.all()) {
    bubble.is_limited = false;
    bubble.conductance = conductance(bubble);
  }
}

void AirEffect::reset_multipliers() {
  for (Bubble& bubble : bubbles_.all()) bubble.gauge = 0.0;
}

double AirEffect::conductance(const Bubble& bubble) const {
  double sum = options_.permeability * bubble.areas.sum() + options_.edge_leak * bubble.edge_length;
  if (wetness_ == nullptr) return sum;
  for (Eigen::Index k = 0; k < bubble.areas.size(); ++k) {
    sum += wetness_->permeability(bubble.vertices[static_cast<std::size_t>(k)]) * bubble.areas[k];
  }
  return sum;
}

void AirEffect::gather(const Positions& x, Bubble& bubble) const {
  bubble.x.resize(3, static_cast<Eigen::Index>(bubble.vertices.size()));
  for (std::size_t k = 0; k < bubble.vertices.size(); ++k) {
    bubble.x.col(static_cast<Eigen::Index>(k)) = x.col(bubble.vertices[k]);
  }
  finder_.find(bubble.x, offset(), bubble.feet);
}

void AirEffect::move(double delta, Bubble& bubble) {
  bubble.moved.resize(3, bubble.x.cols());
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    bubble.moved.col(k) = bubble.x.col(k) + delta * bubble.mobility[k] * bubble.gradient.col(k);
  }
}

double AirEffect::volume_slope(const Bubble& bubble) {
  double slope = 0.0;
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    if (bubble.feet.heights[k] > 0.0) {
      slope += bubble.mobility[k] * bubble.gradient.col(k).squaredNorm();
    }
  }
  return slope;
}

double AirEffect::squeeze(double gauge) const {
  const double share = (options_.atmosphere + gauge) / options_.atmosphere;
  return options_.exponent == 1.0 ? share : std::pow(std::max(0.0, share), 1.0 / options_.exponent);
}

double AirEffect::squeeze_slope(double gauge) const {
  const double pressure = std::max(options_.atmosphere + gauge, kTinyShare * options_.atmosphere);
  return squeeze(gauge) / (options_.exponent * pressure);
}

double AirEffect::solve_pressure_change(Bubble& bubble) const {
  const double pa = options_.atmosphere, gauge = bubble.gauge;
  const double leak = dt_ * bubble.conductance;
  // V_0 of what is there at the pressure p with Darcy's inflow, V (p/p_a)^(1/γ) = V_0 +
  // h Γ (p_a - p), times p_a; increasing in the pressure.
  const auto excess = [&](double delta) -> Sample {
    move(delta, bubble);
    const double v = trapped_volume(bubble.triangles, bubble.moved, bubble.feet);
    const double now = gauge + delta, share = squeeze(now);
    return {pa * (share * v - bubble.amount + leak * now),
            pa * (squeeze_slope(now) * v + leak + share * volume_slope(bubble))};
  };
  const double vacuum = -(pa + gauge);
  const double scale = pa * (bubble.areas.sum() * kTinyHeight + bubble.amount);
  const double delta = root_above(excess, vacuum, kRelativeTolerance * scale);
  // What holds no air presses on nothing, also where cloth passed through itself and its volume is
  // negative: that is for contact to mend.
  return bubble.amount == 0.0 ? std::min(delta, -gauge) : delta;
}

double AirEffect::largest_change(const Bubble& bubble) const {
  double fastest = 0.0;  // displacement per pressure [m/Pa]
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    // A particle that lies on the ground is stopped by it.
    if (bubble.start_heights[k] == 0.0) continue;
    fastest = std::max(fastest, bubble.mobility[k] * bubble.gradient.col(k).norm());
  }
  return fastest > 0.0 ? largest_move_ / fastest : std::numeric_limits<double>::infinity();
}

void AirEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    gather(x, bubble);
    bubble.mobility.resize(bubble.x.cols());
    for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
      bubble.mobility[k] = mobility[bubble.vertices[static_cast<std::size_t>(k)]];
    }
    bubble.start_heights = bubble.feet.heights;
    trapped_volume_gradient(bubble.triangles, bubble.x, bubble.feet, bubble.gradient);
    const double wanted = solve_pressure_change(bubble);
    const double largest = largest_change(bubble);
    const double delta = std::clamp(wanted, -largest, largest);
    bubble.is_limited = delta != wanted;
    bubble.gauge += delta;
    move(delta, bubble);
    for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
      x.col(bubble.vertices[static_cast<std::size_t>(k)]) = bubble.moved.col(k);
    }
  }
}

void AirEffect::add_forces(Forces& f) const {
  for (const Bubble& bubble : bubbles_.all()) {
    // Without a pressure the gradient may be one of a step that was undone.
    if (bubble.is_open || bubble.gauge == 0.0) continue;
    for (Eigen::Index k = 0; k < bubble.gradient.cols(); ++k) {
      f.col(bubble.vertices[static_cast<std::size_t>(k)]) += bubble.gauge * bubble.gradient.col(k);
    }
  }
}

void AirEffect::add_rows(const Positions& x, CouplingRows& rows) {
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    gather(x, bubble);
    const double signed_volume = trapped_volume(bubble.triangles, bubble.x, bubble.feet);
    if (signed_volume < 0.0 && bubble.amount == 0.0 && bubble.gauge == 0.0) continue;
    // From the law that solve_pressure_change() solves, -dV/dp.
    const double v = std::max(0.0, signed_volume);
    const double share = std::max(squeeze(bubble.gauge), kTinyShare);
    rows.begin_row(0.0, (squeeze_slope(bubble.gauge) * v + dt_ * bubble.conductance) / share);
    for (Eigen::Index k = 0; k < bubble.gradient.cols(); ++k) {
      if (bubble.gradient.col(k).isZero(0.0)) continue;
      rows.add(bubble.vertices[static_cast<std::size_t>(k)], bubble.gradient.col(k));
    }
  }
}

void AirEffect::report(StepReport& report) const {
  for (const Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open && bubble.is_limited) report.warn(kLimitedWarning);
  }
}

void AirEffect::after_step(Body& body, double dt) {
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    gather(body.particles().x, bubble);
    const double v = trapped_volume(bubble.triangles, bubble.x, bubble.feet);
    if (v < -kTinyHeight * bubble.areas.sum()) body.report.warn(kPassedWarning);
    bubble.amount = std::max(0.0, bubble.amount - dt * bubble.conductance * bubble.gauge);
  }
  let_in(dt);
}

void AirEffect::add_reactions(std::vector<Reaction>& reactions) const {
  const Positions& x = model_.particles().x;
  for (const Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open || bubble.gauge == 0.0) continue;
    for (Eigen::Index k = 0; k < bubble.gradient.cols(); ++k) {
      const auto o = static_cast<std::size_t>(bubble.feet.nearest[static_cast<std::size_t>(k)]);
      const Eigen::Vector3d force = -bubble.gauge * bubble.gradient.col(k);
      const Eigen::Vector3d at = x.col(bubble.vertices[static_cast<std::size_t>(k)]);
      reactions[o].force += force;
      reactions[o].torque += (at - obstacles_[o].pose_end.translation()).cross(force);
    }
  }
}

double AirEffect::volume(const Bubble& bubble, const Positions& x) const {
  Bubble copy;
  copy.vertices = bubble.vertices;
  gather(x, copy);
  return trapped_volume(bubble.triangles, copy.x, copy.feet);
}

double AirEffect::volume(const Positions& x) const {
  Feet feet;
  finder_.find(x, offset(), feet);
  return trapped_volume(triangles_, x, feet);
}

double AirEffect::pressure() const {
  const Bubble* largest = nullptr;
  for (const Bubble& bubble : bubbles_.all()) {
    if (largest == nullptr || bubble.vertices.size() > largest->vertices.size()) largest = &bubble;
  }
  const bool is_closed = largest != nullptr && !largest->is_open;
  return options_.atmosphere + (is_closed ? largest->gauge : 0.0);
}

double AirEffect::amount() const {
  double sum = loose_;
  for (const Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open) sum += bubble.amount;
  }
  return sum;
}

bool AirEffect::sealed() const {
  return std::none_of(bubbles_.all().begin(), bubbles_.all().end(),
                      [](const Bubble& bubble) { return bubble.is_open; });
}

double AirEffect::energy(const Bubble& bubble, double v) const {
  if (v <= 0.0) return 0.0;
  const double pa = options_.atmosphere, v0 = bubble.amount;
  // Work against the atmosphere less what the air gives: ∫ (p_a - p) dV from V_0 on.
  if (options_.exponent == 1.0) {
    return pa * (v - v0 - (v0 > 0.0 ? v0 * std::log(v / v0) : 0.0));
  }
  const double inner = pa * (v0 * std::pow(v0 / v, options_.exponent - 1.0) - v0);
  return pa * (v - v0) + inner / (options_.exponent - 1.0);
}

double AirEffect::potential_energy(const Body& body) const {
  double sum = 0.0;
  for (const Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open) sum += energy(bubble, volume(bubble, body.particles().x));
  }
  return sum;
}

void AirEffect::reset(Body&) {
  bubbles_.clear();
  start_filling();
}

void AirEffect::save(SavedNumbers& numbers) const {
  numbers.write(loose_);
  numbers.write(filled_);
  bubbles_.save(numbers);
}

void AirEffect::load(SavedNumbers& numbers) {
  loose_ = numbers.read();
  filled_ = numbers.read();
  bubbles_.load(numbers);
}

EffectRegistry::Entry air_entry() {
  return {
      "air",
      "bubbles of air sealed between a wet cloth and what it lies on, at constant amount",
      {number_parameter("volume", "m^3", "0", 0.0, 1e3,
                        "of the sealed air at atmospheric pressure"),
       number_parameter("fill_time", "s", "0", 0.0, 1e6,
                        "over which the air is let in: a cloth that starts flat is inflated then, "
                        "not thrown up; 0: it is there at once"),
       positive_parameter("atmosphere", "Pa", "101325", 1e9, "pressure outside"),
       choice_parameter("gas", "isothermal", {"isothermal", "adiabatic"},
                        "p V is constant, as where air has time to take the room's warmth, or p "
                        "V^1.4"),
       number_parameter("permeability", "m/(s Pa)", "0", 0.0, 1.0,
                        "of the weave: air flow per area and pressure difference"),
       number_parameter("edge_leak", "m^2/(s Pa)", "0", 0.0, 1.0,
                        "air flow per length of lifted edge and pressure difference"),
       flag_parameter("seal_breaks", "true",
                      "air enters a bubble whose edge is lifted; false as in the thesis"),
       positive_parameter("seal_gap", "m", "0.002", 1.0,
                          "height of the edge at which the seal breaks"),
       choice_parameter(
           "obstacles", "auto", {},
           "that the cloth is sealed on, names of obstacles or robot links with commas "
           "between them; auto: the first plane, where there is none all that are no "
           "robot's")},
      {"cloth"},
      [](const Parameters& parameters, const EffectSite& site) {
        AirEffect::Options options;
        options.volume = parameters.number("volume");
        options.fill_time = parameters.number("fill_time");
        options.atmosphere = parameters.number("atmosphere");
        options.permeability = parameters.number("permeability");
        options.seal_breaks = parameters.flag("seal_breaks");
        options.seal_gap = parameters.number("seal_gap");
        options.edge_leak = parameters.number("edge_leak");
        options.exponent = parameters.text("gas") == "adiabatic" ? kAdiabatic : 1.0;
        return std::make_unique<AirEffect>(
            site, sealing_obstacles(parameters.text("obstacles"), site.obstacles), options);
      }};
}

}  // namespace pliant
