#include "pliant/effects/air/air.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/effects/air/air_sealing.h"
#include "pliant/effects/air/bubble_pressure.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/effects/self_contact/self_contact.h"
#include "pliant/effects/self_contact/sheet_contact_detection.h"
#include "pliant/effects/wetness/wetness.h"

namespace pliant {
namespace {

// Share of the mesh width by which one relaxation may move a particle: beyond it the gradient of
// the volume says nothing any more.
constexpr double kLargestMove = 0.25;
// Ratio of the specific heats of air.
constexpr double kAdiabatic = 1.4;
// Air that is squeezed by no more than this share of its volume has its room: a hundred pascals,
// which weigh more than cloth.
constexpr double kSqueezed = 1e-3;
// Sweeps over bubbles that share vertices, at the most; and the share of its pressure by which each
// may still change it when they end.
constexpr int kMostSweeps = 8;
constexpr double kSettled = 1e-9;
const char* const kLimitedWarning =
    "air_limited: the air would move vertices further than a quarter of the mesh width per "
    "iteration; "
    "its pressure is not converged: take a smaller time step, more iterations or a stiffer cloth";
const char* const kEscapesWarning =
    "air_escapes: the edge of the cloth is higher than 'seal_gap' while air is let in, and some of "
    "it goes into the room: hold the edge down ('fixed', 'attachments', 'wetness'), let less in, "
    "or set 'seal_breaks' to false";
// Share of the air beyond which what goes through dry cloth is told.
constexpr double kLeaked = 0.1;
const char* const kDryWarning =
    "air_leaks: more than a tenth of the air has gone through cloth that is not wet, whose weave "
    "lets it pass: wet the cloth further ('wetness', 'radius'), or set 'permeability' of wetness "
    "to 0";
const char* const kPassedWarning =
    "air_negative_volume: cloth over a bubble passed through itself or what it lies on, and has "
    "nothing below it there; add self_contact and contact, or take a smaller time step";

const ContactEffect* contact_of(const Body& body) { return body.find<ContactEffect>(); }

}  // namespace

AirEffect::AirEffect(const EffectSite& site, std::vector<int> sealing, const Options& options)
    : body_(site.body),
      model_(*site.body.model),
      obstacles_(site.obstacles),
      finder_(site.obstacles, std::move(sealing)),
      options_(options),
      triangles_(TriangleMesh{model_.particles().x, triangles_above(model_, finder_)}),
      bubbles_(model_.particles().x, triangles_.corners),
      largest_move_(kLargestMove * std::sqrt(model_.particle_areas().mean())) {
  start_filling();
}

void AirEffect::start_filling() {
  leaked_ = 0.0;
  filled_ = options_.fill_time > 0.0 ? 0.0 : 1.0;
  loose_ = filled_ * options_.volume;
  makes_room_ = loose_ > 0.0;
}

void AirEffect::let_in(double dt) {
  if (filled_ == 1.0) return;
  const double share = std::min(1.0 - filled_, dt / options_.fill_time);
  loose_ += share * options_.volume;
  filled_ += share;
  makes_room_ = makes_room_ || share == 1.0;
}

double AirEffect::left(const Bubble& bubble, double dt) {
  return std::max(0.0, bubble.amount - dt * bubble.conductance * bubble.gauge);
}

bool AirEffect::is_squeezed() const {
  return std::any_of(bubbles_.all().begin(), bubbles_.all().end(), [](const Bubble& bubble) {
    return !bubble.is_open && bubble.amount > (1.0 + kSqueezed) * bubble.start_volume;
  });
}

// Air squeezed into no volume would have more energy than any cloth can take: how much of it the
// cloth got would be a matter of the time step alone. So air that is there at once comes at the
// pressure of the room, and the cloth goes to where it holds it as it is put there, not thrown.
void AirEffect::make_room(Particles& particles) {
  makes_room_ = false;
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open || !(bubble.amount > (1.0 + kSqueezed) * bubble.start_volume)) continue;
    measure_layers(particles.x, bubble);
    const double now = std::max(0.0, air_volume(bubble));
    made_room_ = true;
    for (const int i : bubble.vertices) particles.v.col(i) = particles.v_start.col(i);
    particles.history.dt = 0.0;
    bubble.gauge = 0.0;
    // Few iterations leave some for the next steps. What does not grow any more is held down.
    const bool grew = now > (1.0 + kSqueezed) * bubble.start_volume;
    makes_room_ = makes_room_ || (grew && bubble.amount > (1.0 + kSqueezed) * now);
  }
}

double AirEffect::offset() const {
  const ContactEffect* contact = contact_of(body_);
  return contact == nullptr ? 0.0 : contact->offset();
}

double AirEffect::layer_thickness() const {
  SelfContactEffect* own = body_.find<SelfContactEffect>();
  return own == nullptr ? 0.0 : own->detection().sheet_thickness();
}

void AirEffect::measure_layers(const Positions& x, Bubble& bubble) const {
  gather(x, bubble);
  bubble.layers =
      layer_volume(bubble.triangles.corners, bubble.x, bubble.foot_points, layer_thickness());
}

void AirEffect::begin_step(const Particles& particles, double dt) {
  dt_ = dt;
  wetness_ = body_.find<WetnessEffect>();
  contact_ = contact_of(body_);
  if (contact_ != nullptr && !contact_->is_wet()) contact_ = nullptr;
  finder_.find(particles.x_start, offset(), foot_points_);
  const double gap =
      options_.seal_breaks ? options_.seal_gap : std::numeric_limits<double>::infinity();
  const bool comes = loose_ > 0.0;
  bubbles_.follow(foot_points_.heights, gap, loose_, [&](Bubble& bubble) {
    measure_layers(particles.x_start, bubble);
    return air_volume(bubble);
  });
  const auto& all = bubbles_.all();
  const auto is_open = [](const Bubble& bubble) { return bubble.is_open; };
  escapes_ = (comes && std::all_of(all.begin(), all.end(), is_open)) ||
             (made_room_ && std::any_of(all.begin(), all.end(), is_open));
  for (Bubble& bubble : bubbles_.all()) {
    measure_layers(particles.x_start, bubble);
    bubble.start_volume = std::max(0.0, air_volume(bubble));
    bubble.is_limited = false;
    bubble.start_gauge = bubble.gauge;
    bubble.expected = 0.0;
    bubble.pressed = 0.0;
    bubble.conductance = conductance(bubble);
  }
  bubbles_.lying().gauge = bubbles_.lying().pressed = 0.0;
  bubbles_.lying().conductance = conductance(bubbles_.lying());
}

void AirEffect::reset_multipliers() {
  for (Bubble& bubble : bubbles_.all()) bubble.gauge = 0.0;
}

double AirEffect::conductance(const Bubble& bubble) const {
  return options_.permeability * bubble.areas.sum() + options_.edge_leak * bubble.edge_length +
         dry_conductance(bubble);
}

double AirEffect::dry_conductance(const Bubble& bubble) const {
  double sum = 0.0;
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
  finder_.find(bubble.x, offset(), bubble.foot_points);
}

void AirEffect::gather_mobility(const Eigen::VectorXd& mobility, Bubble& bubble) {
  bubble.mobility.resize(bubble.x.cols());
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    bubble.mobility[k] = mobility[bubble.vertices[static_cast<std::size_t>(k)]];
  }
}

void AirEffect::scatter(const Bubble& bubble, Positions& x) {
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    x.col(bubble.vertices[static_cast<std::size_t>(k)]) = bubble.moved.col(k);
  }
}

void AirEffect::gather_held(Bubble& bubble) {
  bubble.held.resize(contact_ == nullptr ? 0 : bubble.x.cols());
  for (Eigen::Index k = 0; k < bubble.held.size(); ++k) {
    bubble.held[k] = bubble.mobility[k] * holds_[bubble.vertices[static_cast<std::size_t>(k)]];
  }
}

void AirEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (contact_ != nullptr) {
    holds_.setZero(x.cols());
    for (const Contact& contact : contact_->contacts()) {
      if (contact.adhesion == 0.0) continue;
      holds_[contact.point] += std::max(0.0, contact.adhesion + contact.normal_force);
    }
  }
  for (Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open) relax_first(mobility, bubble, x);
  }
  // What a bubble moves of the vertices that it shares with its neighbours changes their volumes.
  bool goes_on = bubbles_.share_vertices();
  for (int sweep = 1; goes_on && sweep < kMostSweeps; ++sweep) {
    goes_on = false;
    for (Bubble& bubble : bubbles_.all()) {
      if (!bubble.is_open && !bubble.is_limited && relax_further(bubble, x)) goes_on = true;
    }
  }
}

void AirEffect::relax_first(const Eigen::VectorXd& mobility, Bubble& bubble, Positions& x) {
  gather(x, bubble);
  gather_mobility(mobility, bubble);
  gather_held(bubble);
  // Of what water holds it is not known how far it will go.
  const bool goes_ahead = bubble.amount > 0.0 && bubble.held.size() == 0;
  double ahead = goes_ahead ? bubble.expected - bubble.gauge : 0.0;
  if (ahead != 0.0 && std::abs(ahead) > largest_pressure_change(bubble, largest_move_)) {
    ahead = 0.0;  // beyond where the last gradient says anything
  }
  take_gradient(bubble, ahead);
  double delta = 0.0;
  bubble.is_limited = !adjust_pressure(bubble, x, delta);
}

bool AirEffect::relax_further(Bubble& bubble, Positions& x) {
  gather(x, bubble);
  keep_gradient(bubble);
  double delta = 0.0;
  adjust_pressure(bubble, x, delta);
  return std::abs(delta) > kSettled * std::abs(bubble.gauge);
}

bool AirEffect::adjust_pressure(Bubble& bubble, Positions& x, double& delta) const {
  const double wanted = pressure_change(options_.gas, dt_ * bubble.conductance, bubble);
  const double largest = largest_pressure_change(bubble, largest_move_);
  delta = std::clamp(wanted, -largest, largest);
  bubble.gauge += delta;
  bubble.expected = bubble.gauge;
  move_bubble(delta, bubble);
  scatter(bubble, x);
  return delta == wanted;
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

void AirEffect::add_rows(const Positions& x, ConstraintRows& rows) {
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    gather(x, bubble);
    const double signed_volume = air_volume(bubble);
    if (signed_volume < 0.0 && bubble.amount == 0.0 && bubble.gauge == 0.0) continue;
    // From the law that pressure_change() solves, -dV/dp.
    const AirGas& gas = options_.gas;
    const double v = std::max(0.0, signed_volume);
    const double share = std::max(gas.squeeze(bubble.gauge), AirGas::kTinyShare);
    rows.begin_row(0.0, (gas.squeeze_slope(bubble.gauge) * v + dt_ * bubble.conductance) / share);
    for (Eigen::Index k = 0; k < bubble.gradient.cols(); ++k) {
      if (bubble.gradient.col(k).isZero(0.0)) continue;
      rows.add(bubble.vertices[static_cast<std::size_t>(k)], bubble.gradient.col(k));
    }
  }
}

bool AirEffect::takes_multipliers() const {
  return std::all_of(bubbles_.all().begin(), bubbles_.all().end(),
                     [](const Bubble& bubble) { return bubble.is_open || bubble.amount > 0.0; });
}

bool AirEffect::is_idle() const {
  return std::all_of(bubbles_.all().begin(), bubbles_.all().end(),
                     [](const Bubble& bubble) { return bubble.is_open; });
}

void AirEffect::warm_start() {
  for (Bubble& bubble : bubbles_.all()) bubble.gauge = bubble.start_gauge;
}

void AirEffect::add_point_constraints(const Positions& x, PointConstraints& constraints) {
  first_tie_ = constraints.ties.size();
  // Bubbles grow: so that their constraints do not take memory for it later.
  constraints.gradients.reserve(static_cast<std::size_t>(x.cols()));
  tied_.clear();
  for (std::size_t b = 0; b < bubbles_.all().size(); ++b) {
    Bubble& bubble = bubbles_.all()[b];
    if (bubble.is_open) continue;
    gather(x, bubble);
    // Where nothing moved yet, the place for that holds the gradient until multipliers are taken.
    trapped_volume_gradient(bubble.triangles, bubble.x, bubble.foot_points, bubble.moved);
    TyingConstraint& tie = constraints.append_tie();
    const double leak = dt_ * bubble.conductance;
    set_gas_constraint(options_.gas, leak, bubble, tie);
    tie.reach = largest_move_;
    for (Eigen::Index k = 0; k < bubble.moved.cols(); ++k) {
      if (bubble.moved.col(k).isZero(0.0)) continue;
      constraints.add_gradient(bubble.vertices[static_cast<std::size_t>(k)], bubble.moved.col(k));
    }
    tied_.push_back(static_cast<int>(b));
  }
}

void AirEffect::take_multipliers(const PointConstraints& constraints) {
  for (std::size_t k = 0; k < tied_.size(); ++k) {
    Bubble& bubble = bubbles_.all()[static_cast<std::size_t>(tied_[k])];
    bubble.gauge = constraints.ties[first_tie_ + k].force;
    bubble.gradient = bubble.moved;
  }
}

void AirEffect::report(StepReport& report) const {
  if (escapes_) report.warn(kEscapesWarning);
  for (const Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open && bubble.is_limited) report.warn(kLimitedWarning);
  }
}

void AirEffect::after_step(Body& body, double dt) {
  const double before = leaked_;
  for (Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    gather(body.particles().x, bubble);
    const double v = trapped_volume(bubble.triangles, bubble.x, bubble.foot_points);
    if (v < -kTinyBubbleHeight * bubble.areas.sum()) body.report.warn(kPassedWarning);
    if (bubble.gauge > 0.0) {
      leaked_ += std::min(bubble.amount, dt * dry_conductance(bubble) * bubble.gauge);
    }
    bubble.amount = left(bubble, dt);
  }
  if (leaked_ > before && leaked_ > kLeaked * options_.volume) body.report.warn(kDryWarning);
  made_room_ = false;
  if (makes_room_) make_room(body.particles());
  let_in(dt);
}

void AirEffect::add_reactions(std::vector<Reaction>& reactions) const {
  for (const Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open) add_reactions(bubble, reactions);
  }
  add_reactions(bubbles_.lying(), reactions);
}

void AirEffect::add_reactions(const Bubble& bubble, std::vector<Reaction>& reactions) const {
  if (bubble.gauge == 0.0) return;
  const Positions& x = model_.particles().x;
  for (Eigen::Index k = 0; k < bubble.gradient.cols(); ++k) {
    const auto o =
        static_cast<std::size_t>(bubble.foot_points.nearest[static_cast<std::size_t>(k)]);
    const Eigen::Vector3d force = -bubble.gauge * bubble.gradient.col(k);
    const Eigen::Vector3d at = x.col(bubble.vertices[static_cast<std::size_t>(k)]);
    reactions[o].force += force;
    reactions[o].torque += (at - obstacles_[o].pose_end.translation()).cross(force);
  }
}

double AirEffect::volume(const Bubble& bubble, const Positions& x) const {
  // Kept, so that it allocates nothing once it is warm.
  static thread_local Bubble copy;
  copy.vertices = bubble.vertices;
  copy.triangles = bubble.triangles;
  measure_layers(x, copy);
  return air_volume(copy);
}

double AirEffect::volume(const Positions& x) const {
  FootPoints foot_points;
  finder_.find(x, offset(), foot_points);
  return trapped_volume(triangles_, x, foot_points) -
         layer_volume(triangles_.corners, x, foot_points, layer_thickness());
}

double AirEffect::pressure() const {
  const Bubble* largest = nullptr;
  for (const Bubble& bubble : bubbles_.all()) {
    if (largest == nullptr || bubble.vertices.size() > largest->vertices.size()) largest = &bubble;
  }
  const bool is_closed = largest != nullptr && !largest->is_open;
  return options_.gas.atmosphere + (is_closed ? largest->gauge : 0.0);
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

double AirEffect::least_volume(const Bubble& bubble) {
  return std::min(bubble.amount, kTinyBubbleHeight * bubble.areas.sum());
}

double AirEffect::potential_energy(const Body& body) const {
  double sum = 0.0;
  for (const Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    const double v = std::max(least_volume(bubble), volume(bubble, body.particles().x));
    sum += options_.gas.energy(bubble.amount, v);
  }
  return sum;
}

double AirEffect::work(const Positions& x) const {
  // Air that is squeezed, or nearly a vacuum, can lose joules in one step, far more than its
  // pressure at the step's end gives to the cloth. If all of that counted, cloth might gain as much
  // by errors.
  double sum = 0.0;
  for (const Bubble& bubble : bubbles_.all()) {
    if (bubble.is_open) continue;
    const double least = least_volume(bubble);
    const double start = std::max(least, bubble.start_volume);
    const double end = std::max(least, volume(bubble, x));
    // What leaks out leaves room without being squeezed.
    const double lost =
        options_.gas.energy(bubble.amount, start) - options_.gas.energy(left(bubble, dt_), end);
    sum += std::min(lost, bubble.gauge * (end - start));
  }
  return sum;
}

void AirEffect::reset(Body&) {
  bubbles_.clear();
  start_filling();
}

void AirEffect::undo_step() {
  for (Bubble& bubble : bubbles_.all()) bubble.gauge = bubble.start_gauge;
}

void AirEffect::save(StateArchive& numbers) const {
  numbers.write(loose_);
  numbers.write(filled_);
  numbers.write(leaked_);
  numbers.write(makes_room_ ? 1.0 : 0.0);
  bubbles_.save(numbers);
}

void AirEffect::load(StateArchive& numbers) {
  loose_ = numbers.read();
  filled_ = numbers.read();
  leaked_ = numbers.read();
  makes_room_ = numbers.read() == 1.0;
  bubbles_.load(numbers);
}

EffectRegistry::Entry air_entry() {
  return {
      "air",
      "bubbles of air sealed between a wet cloth and what it lies on, at constant amount",
      {number_parameter("volume", "m^3", "0", 0.0, 1e3,
                        "of the sealed air at atmospheric pressure"),
       number_parameter(
           "fill_time", "s", "0", 0.0, 1e6,
           "over which the air is let in; 0: it is there at once, and a cloth that does "
           "not hold it yet is put to where it does, without speed"),
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
        options.gas.atmosphere = parameters.number("atmosphere");
        options.permeability = parameters.number("permeability");
        options.seal_breaks = parameters.flag("seal_breaks");
        options.seal_gap = parameters.number("seal_gap");
        options.edge_leak = parameters.number("edge_leak");
        options.gas.exponent = parameters.text("gas") == "adiabatic" ? kAdiabatic : 1.0;
        return std::make_unique<AirEffect>(
            site, sealing_obstacles(parameters.text("obstacles"), site.obstacles), options);
      }};
}

}  // namespace pliant
