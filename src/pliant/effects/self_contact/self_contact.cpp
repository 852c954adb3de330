#include "pliant/effects/self_contact/self_contact.h"

#include <fmt/format.h>

#include <utility>

#include "pliant/core/body.h"
#include "pliant/effects/contact/particle_contact_detection.h"
#include "pliant/effects/self_contact/self_contact_detection.h"
#include "pliant/effects/self_contact/sheet_contact_detection.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

std::unique_ptr<PairDetection> make_detection(Model& model, const PairDetection::Options& options) {
  if (auto* blend = model.find<BlendedParticles>()) {
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
    : PairContactEffect(std::move(detection), thickness) {}

void SelfContactEffect::report(StepReport& report) const {
  PairContactEffect::report(report);
  if (!is_crowded()) return;
  report.failure = fmt::format(
      "body '{}': self_contact finds more than {} pairs of places that touch, about a hundred for "
      "each vertex: the cloth fell into a heap in which nothing is kept apart; the step was "
      "undone. "
      "Reset the body, and try a smaller time step or another solver.",
      body_, most_contacts());
}

std::string_view SelfContactEffect::held_back() const {
  return "self_contact_held_back: some vertices went less far than they should, since the cloth "
         "would have passed through itself; take a smaller time step or more iterations";
}

void SelfContactEffect::before_step(Body& body, double) {
  body_ = body.name;
  std::string failure = detection().take_device_failure();
  const bool on_gpu = body.solver->runs_on_gpu();
  if (on_gpu != is_on_gpu_) {
    is_on_gpu_ = on_gpu;
    try {
      detection().search_on_gpu(on_gpu);
    } catch (const DeviceFailure& reason) {
      failure = reason.what();
    }
  }
  if (!failure.empty()) {
    body.report.warn("self_contact_cpu: not on the GPU, but on the CPU: " + failure);
  }
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
