#include "pliant/effects/body_contact/body_contact.h"

#include <algorithm>
#include <utility>

#include "pliant/core/body.h"
#include "pliant/core/group.h"

namespace pliant {
namespace {

// A friction force below this share of its bound holds its pair: it sticks.
constexpr double kSticks = 1.0 - 1e-9;
// Of the thickness: what no solver bends a rigid body by.
constexpr double kMostBend = 0.25;

/// Of a body whose group's contacts another one holds, or that is alone in its group.
class BodyContactMember final : public Effect {
 public:
  std::string_view name() const override { return "body_contact"; }
};

}  // namespace

BodyContactEffect::BodyContactEffect(std::unique_ptr<PairDetection> owned,
                                     BodyContactDetection& detection, double thickness)
    : PairContactEffect(std::move(owned), thickness), detection_(detection) {}

void BodyContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  opened_before_ = detection_.opened();
  detection_.open(dt);
  PairContactEffect::begin_step(particles, dt);
  restored_.begin_step();
  take_back();
}

void BodyContactEffect::take_back() {
  if (!restored_.owes(particles_->x)) return;
  for (PairContact& pair : contacts()) {
    const Eigen::Vector3d by = pair.relative(restored_.by());
    if (!restored_.owes(detection_.bodies_of(pair), by, kMostBend * detection_.thickness())) {
      continue;
    }
    pair.owed = by - pair.normal * pair.normal.dot(by);
    pair.start -= pair.owed;
  }
}

void BodyContactEffect::final_projection(const Eigen::VectorXd& mobility, Positions& x) {
  PairContactEffect::final_projection(mobility, x);
  if (detection_.surfaces().has_rigid()) restored_.note_bent(x);
}

void BodyContactEffect::note_restored() {
  if (particles_ == nullptr) return;
  // Where nothing got a shape back, nothing is owed any more.
  if (!restored_.has_bent()) return restored_.end_step(particles_->x);
  for (const PairContact& pair : contacts()) {
    const double bound = pair.friction * std::max(0.0, pair.normal_force + pair.adhesion);
    const bool has_stuck = pair.friction_force.norm() < kSticks * bound;
    if (has_stuck && detection_.is_of_rigid(pair)) {
      restored_.note_stuck(detection_.bodies_of(pair));
    }
  }
  restored_.end_step(particles_->x);
  // What is soft is where it is.
  detection_.surfaces().leave_rigid(restored_.by());
}

void BodyContactEffect::after_step(Body& body, double dt) {
  PairContactEffect::after_step(body, dt);
  note_restored();
}

void BodyContactEffect::undo_step() {
  PairContactEffect::undo_step();
  detection_.set_opened(opened_before_);
  restored_.undo_step();
}

void BodyContactEffect::reset(Body& body) {
  PairContactEffect::reset(body);
  detection_.set_opened(0.0);
  restored_.reset();
}

void BodyContactEffect::save(StateArchive& numbers) const {
  PairContactEffect::save(numbers);
  numbers.write(detection_.opened());
  restored_.save(numbers);
}

void BodyContactEffect::load(StateArchive& numbers) {
  PairContactEffect::load(numbers);
  detection_.set_opened(numbers.read());
  restored_.load(numbers);
}

std::string_view BodyContactEffect::held_back() const {
  return "body_contact_held_back: some vertices went less far than they should, since bodies would "
         "have passed through each other; take a smaller time step or more iterations";
}

EffectRegistry::Entry body_contact_entry() {
  return {"body_contact",
          "keeps the bodies of a scene out of each other, whatever their models, with friction",
          {positive_parameter("thickness", "m", "0.002", 1.0, "distance that surfaces keep"),
           number_parameter("margin", "m", "0.0005", 0.0, 1.0,
                            "contacts open by less than this take part in the iterations"),
           number_parameter("friction", "", "0.5", 0.0, 100.0,
                            "Coulomb coefficient, static and dynamic")},
          {"cloth", "patch", "reduced", "viscoelastic", "rigid"},
          [](const Parameters& parameters, const EffectSite& site) -> std::unique_ptr<Effect> {
            const Group& group = *site.body.group;
            if (group.joint() == nullptr || &group.first() != &site.body) {
              return std::make_unique<BodyContactMember>();
            }
            const PairDetection::Options options{parameters.number("thickness"),
                                                 parameters.number("margin"),
                                                 parameters.number("friction")};
            const BodyPairTable pairs(group, site.pairs, options);
            auto owned = std::make_unique<BodyContactDetection>(group, pairs, options);
            BodyContactDetection& detection = *owned;
            return std::make_unique<BodyContactEffect>(std::move(owned), detection,
                                                       pairs.least_thickness());
          },
          {positive_parameter("thickness", "m", "", 1.0, "instead of the one for all pairs"),
           number_parameter("friction", "", "", 0.0, 100.0, "instead of the one for all pairs")}};
}

}  // namespace pliant
