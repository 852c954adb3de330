#include "pliant/models/viscoelastic/heat_parameters.h"
#include "pliant/models/viscoelastic/viscoelastic.h"

namespace pliant {
namespace {

// Of a rigid body: it gives way by a hundredth of what an impulse of one step would move it.
constexpr double kRigidAlpha = 0.99;

double beta_of(const std::string& state) {
  if (state == "liquid") return 1.0;
  return state == "viscoelastic" ? 0.5 : 0.0;
}

TurnBlend turn_blend_of(const std::string& name) {
  if (name == "qlerp") return TurnBlend::kLinear;
  return name == "exponential" ? TurnBlend::kExponential : TurnBlend::kMoments;
}

ViscoelasticModel::Material material_of(const Parameters& given) {
  ViscoelasticModel::Material material;
  const std::string& state = given.text("state");
  material.liquid = {given.number("density"), given.number("sound_speed"),
                     given.number("viscosity")};
  material.solid.rigid = state == "rigid";
  material.solid.young = given.number("young");
  material.solid.alpha = given.number("alpha");
  if (material.solid.rigid && material.solid.alpha == 0.0) material.solid.alpha = kRigidAlpha;
  material.solid.cluster_radius = given.number("cluster_radius");
  material.solid.cluster_fraction = given.number("cluster_fraction");
  material.beta = given.number("beta") < 0.0 ? beta_of(state) : given.number("beta");
  material.oriented = given.flag("oriented");
  material.turn_blend = turn_blend_of(given.text("turn_blend"));
  material.surface_detail = given.integer("surface_detail");
  material.anisotropic_surface = given.text("surface") == "anisotropic";
  material.max_substeps = given.integer("max_substeps");
  material.heat = heat_properties(given);
  return material;
}

std::vector<ParameterSpec> parameters() {
  std::vector<ParameterSpec> specs = {
      choice_parameter("state", "elastic", {"rigid", "elastic", "viscoelastic", "liquid"},
                       "preset of beta: 0, 0, 0.5, 1; rigid: one cluster of all particles"),
      number_parameter("beta", "", "-1", -1.0, 1.0,
                       "0 solid to 1 liquid, instead of the state's; negative: the state's"),
      positive_parameter("density", "kg/m^3", "1000", 1e6, "mass per volume at rest"),
      positive_parameter("young", "Pa", "1e4", 1e12, "Young's modulus of what is solid"),
      number_parameter("alpha", "", "0", 0.0, 0.9999,
                       "stiffness as in shape matching, of one time step; 0: by `young`, which "
                       "does not depend on the step"),
      number_parameter("cluster_radius", "m", "0", 0.0, 1e6,
                       "of the groups that keep their shape; 0: 2.1 particle spacings"),
      number_parameter("cluster_fraction", "", "0.25", 1e-6, 1.0,
                       "of the particles that are centres of a group; raised where they would not "
                       "cover all"),
      flag_parameter("oriented", "false", "particles turn: thin shapes resist bending and torsion"),
      choice_parameter("turn_blend", "moments", {"moments", "qlerp", "exponential"},
                       "how an oriented particle's turn follows those of its groups: by their "
                       "moments, which minimises the energy, or by a mean of quaternions, linear "
                       "or by the exponential map"),
      positive_parameter("sound_speed", "m/s", "5", 1e5,
                         "of the liquid; ten times the fastest motion keeps density within 1 %"),
      number_parameter("viscosity", "Pa s", "0.1", 0.0, 1e6, "of the liquid"),
      choice_parameter("surface", "smooth", {"smooth", "anisotropic"},
                       "smooth: round kernels, fast; anisotropic: kernels that lie along the "
                       "surface, flatter and several times slower, with a detail of 3 at least"),
      integer_parameter("surface_detail", "2", 2, 8,
                        "of the drawn surface: marching cubes along two particle spacings"),
      renamed(integer_parameter("max_substeps", "1000", 1, 1e6,
                                "most substeps of a time step that the liquid may need"),
              "max_parts"),
  };
  for (ParameterSpec& spec : heat_parameters()) specs.push_back(std::move(spec));
  return specs;
}

}  // namespace

ModelRegistry::Entry viscoelastic_entry() {
  return {"viscoelastic",
          "bodies of particles from rigid over elastic to liquid: shape matching and SPH, blended",
          parameters(),
          {"viscoelastic"},
          [](const Parameters& given, const BodyGeometry& geometry) {
            return std::make_unique<ViscoelasticModel>(geometry, material_of(given));
          }};
}

}  // namespace pliant
