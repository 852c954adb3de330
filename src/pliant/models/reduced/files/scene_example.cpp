#include "pliant/models/reduced/files/scene_example.h"

#include <utility>

#include "pliant/elements/solids/averaged_tetrahedra.h"
#include "pliant/models/reduced/files/example_bodies.h"

namespace pliant {

std::vector<ParameterSpec> scene_example_parameters() {
  return {
      choice_parameter("name", "", example_names(), "which body"),
      positive_parameter("scale", "", "1", 1e6, "of its size"),
      number_parameter("young", "Pa", "0", 0.0, 1e15, "Young's modulus; 0: the body's own"),
      number_parameter("poisson", "", "0.3", -0.99, 0.499, "Poisson's ratio"),
      number_parameter("density", "kg/m^3", "0", 0.0, 1e9, "mass per volume; 0: the body's own"),
      strain_parameter(),
      integer_parameter("modes", "0", 0, 1000, "linear modes; 0: the body's own number"),
      integer_parameter("rank", "0", 0, kMaxRank, "coordinates; 0: the body's own number")};
}

ReducedModel reduce_scene_example(const Parameters& parameters) {
  ExampleBody example = example_body(parameters.text("name"));
  example.mesh.vertices *= parameters.number("scale");
  example.surface.vertices *= parameters.number("scale");
  if (parameters.number("young") > 0.0) example.material.young = parameters.number("young");
  example.material.poisson = parameters.number("poisson");
  if (parameters.number("density") > 0.0) {
    example.material.density = parameters.number("density");
  }
  if (parameters.integer("modes") > 0) example.reduction.modes = parameters.integer("modes");
  if (parameters.integer("rank") > 0) example.reduction.rank = parameters.integer("rank");
  example.averaged = parameters.text("strain") == kAveragedStrain;
  const StvkBody body(std::move(example.mesh), example.material, example.fixed, example.name,
                      example.averaged);
  ReducedModel model = *reduce(body, example.reduction, example.name,
                               [](double, double, const std::string&) { return true; });
  model.surface = std::move(example.surface);
  return model;
}

}  // namespace pliant
