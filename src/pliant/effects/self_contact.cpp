#include "pliant/effects/self_contact.h"

#include <utility>

#include "pliant/core/body.h"
#include "pliant/effects/particle_contact_detection.h"
#include "pliant/effects/self_contact_detection.h"
#include "pliant/effects/sheet_contact_detection.h"
#include "pliant/solvers/backend.h"

namespace pliant {
namespace {

const char* const kHeldBackWarning =
    "self_contact_held_back: some vertices went less far than they should, since the cloth would "
    "have passed through itself; take a smaller time step or more iterations";

std::unique_ptr<PairDetection> make_detection(Model& model, const PairDetection::Options& options) {
  if (auto* blend = dynamic_cast<BlendedParticles*>(&model)) {
    return std::make_unique<ParticleContactDetection>(*blend, options);
  }
  if (const TetrahedralMesh* solid = model.tetrahedra()) {
    SelfContactParts parts(*solid, model.surface_triangles(), model.surface_points(),
                           model.contact_points());
    return std::make_unique<SelfContactDetection>(std::move(parts), options);
  }
  return std::make_unique<SheetContactDetection>(model.particles().x, model.surface_triangles(),
                                                 options);
}

}  // namespace
SelfContactEffect::SelfContactEffect(std::unique_ptr<PairDetection> detection, double thickness)
    : detection_(std::move(detection)),
      pairs_(thickness, detection_->sweeps()),
      rest_(thickness, 1) {}

void SelfContactEffect::reset(Body&) { pairs_.all().clear(); }

void SelfContactEffect::before_step(Body& body, double) {
  std::string failure = detection_->take_device_failure();
  const bool on_gpu = runs_on_gpu(*body.solver);
  if (on_gpu != is_on_gpu_) {
    is_on_gpu_ = on_gpu;
    try {
      detection_->search_on_gpu(on_gpu);
    } catch (const DeviceFailure& reason) {
      failure = reason.what();
    }
  }
  if (!failure.empty()) {
    body.report.warn("self_contact_cpu: not on the GPU, but on the CPU: " + failure);
  }
}

void SelfContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  dt_ = dt;
  has_rest_ = is_held_back_ = false;
  detection_->find(particles, dt, pairs_.all());
}

void SelfContactEffect::add_constraints(const Positions& x, PointConstraints& constraints) {
  first_constraint_ = constraints.all.size();
  for (const PairContact& pair : pairs_.all()) {
    PointConstraint& constraint = constraints.append();
    const Eigen::Vector3d relative = pair.relative(x);
    const Eigen::Vector3d path = relative - pair.start;
    constraint.normal = pair.normal;
    constraint.gap = pair.normal.dot(relative) - pair.least;
    constraint.slip = path - pair.normal * pair.normal.dot(path);
    constraint.lowest = -pair.pull;
    constraint.friction = pair.friction;
    constraint.normal_force = pair.normal_force;
    constraint.friction_force = pair.friction_force;
    for (std::size_t k = 0; k < pair.count; ++k) {
      constraints.add(pair.particles[k], pair.weights[k]);
    }
  }
}

void SelfContactEffect::take_multipliers(const PointConstraints& constraints) {
  for (std::size_t c = 0; c < pairs_.all().size(); ++c) {
    const PointConstraint& constraint = constraints.all[first_constraint_ + c];
    pairs_.all()[c].normal_force = constraint.normal_force;
    pairs_.all()[c].friction_force = constraint.friction_force;
  }
}

void SelfContactEffect::finish(const Eigen::VectorXd& mobility, Positions& x) {
  if (detection_->is_final()) return;
  detection_->find_again(*particles_, dt_, pairs_.all());
  pairs_.separate(mobility, x);
}

double SelfContactEffect::settle(const Eigen::VectorXd& mobility, Positions& x) {
  if (detection_->is_final()) return 0.0;
  return (has_rest_ ? rest_ : pairs_).settle(mobility, x);
}

bool SelfContactEffect::advance(Positions& x) {
  is_held_back_ = !detection_->advance(*particles_, dt_, x, rest_.all());
  has_rest_ = has_rest_ || is_held_back_;
  return !is_held_back_;
}

void SelfContactEffect::report(StepReport& report) const {
  report.contacts += active();
  if (const double search = detection_->take_search_seconds(); search > 0.0) {
    // A line of its own, beside what the effect takes otherwise.
    report.add_time("self_contact_search", search);
    report.add_time(name(), -search);
  }
  if (is_held_back_) report.warn(kHeldBackWarning);
}

EffectRegistry::Entry self_contact_entry() {
  return {"self_contact",
          "keeps the bodies of a scene out of each other and each out of itself, with friction",
          {positive_parameter("thickness", "m", "0.002", 1.0,
                              "distance that surfaces keep; particles keep their spacing at least"),
           number_parameter("margin", "m", "0.0005", 0.0, 1.0,
                            "contacts open by less than this take part in the iterations"),
           number_parameter("friction", "", "0.5", 0.0, 100.0,
                            "Coulomb coefficient, static and dynamic")},
          {"cloth", "patch", "viscoelastic"},
          [](const Parameters& parameters, const EffectSite& site) {
            const PairDetection::Options options{parameters.number("thickness"),
                                                 parameters.number("margin"),
                                                 parameters.number("friction")};
            return std::make_unique<SelfContactEffect>(make_detection(*site.body.model, options),
                                                       options.thickness);
          }};
}

}  // namespace pliant
