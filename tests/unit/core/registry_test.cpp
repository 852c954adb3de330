#include "pliant/core/registry.h"

#include <gtest/gtest.h>

#include "pliant/effects/registry.h"
#include "pliant/elements/registry.h"
#include "pliant/models/reduced/integrators/integrator.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"
#include "pliant/solvers/registry.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

using IntRegistry = Registry<int, int>;

IntRegistry numbers() {
  IntRegistry registry("number");
  registry.add({"double", "twice", {}, {"cloth", "patch"}, [](const Parameters&, int x) {
                  return std::make_unique<int>(2 * x);
                }});
  registry.add({"triple", "three times", {}, {"patch"}, [](const Parameters&, int x) {
                  return std::make_unique<int>(3 * x);
                }});
  return registry;
}

TEST(Registry, FindsAndMakes) {
  const IntRegistry registry = numbers();
  EXPECT_EQ(registry.kind(), "number");
  EXPECT_EQ(registry.names(), (std::vector<std::string>{"double", "triple"}));
  EXPECT_EQ(registry.names_for("cloth"), (std::vector<std::string>{"double"}));
  EXPECT_EQ(*registry.find("double").make(Parameters(), 4), 8);
  EXPECT_EQ(*registry.find_for("triple", "patch").make(Parameters(), 4), 12);
}

TEST(Registry, RefusesUnknownNames) {
  const IntRegistry registry = numbers();
  expect_refusal([&] { registry.find("tripel"); },
                 {"unknown number 'tripel'", "double, triple", "did you mean 'triple'?"});
  expect_refusal([&] { registry.find_for("", "cloth"); }, {"unknown number ''"});
}

TEST(Registry, RefusesUnsuitableOnesWithThoseThatDo) {
  const IntRegistry registry = numbers();
  expect_refusal([&] { registry.find_for("triple", "cloth"); },
                 {"number 'triple' does not work for model 'cloth'", "these do: double"});
}

template <class AnyRegistry>
void expect_described(const AnyRegistry& registry) {
  for (const auto& entry : registry.entries()) {
    SCOPED_TRACE(registry.kind() + " " + entry.name);
    EXPECT_FALSE(entry.description.empty());
    EXPECT_EQ(entry.description.find('\n'), std::string::npos);
    EXPECT_FALSE(entry.models.empty());
    for (const std::string& model : entry.models) EXPECT_NO_THROW(model_registry().find(model));
    for (const ParameterSpec& spec : entry.parameters) {
      EXPECT_FALSE(spec.meaning.empty()) << spec.name;
      EXPECT_FALSE(spec.default_value.empty()) << spec.name;
    }
    // Every default lies in its own range.
    EXPECT_NO_THROW(parse_parameters(entry.parameters, {}, entry.name));
  }
}

TEST(BuiltInRegistries, DescribeEverythingOnce) {
  expect_described(all_solvers());
  expect_described(effect_registry());
  expect_described(model_registry());
  for (const ElementKind& kind : element_kinds()) EXPECT_FALSE(kind.description.empty());
}

TEST(BuiltInRegistries, HoldWhatTheDocumentsPromise) {
  for (const char* solver : {"verlet", "xpbd", "jacobi", "line_search_jacobi", "gauss_seidel",
                             "hybrid", "chebyshev", "direct", "lbfgs", "newton"}) {
    EXPECT_NO_THROW(solver_registry().find_for(solver, "cloth"));
  }
  for (const char* solver :
       {"trigonometric", "imex_thesis", "newmark", "midpoint", "stoermer_verlet", "reference"}) {
    EXPECT_NO_THROW(all_solvers().find_for(solver, "reduced"));
  }
  EXPECT_EQ(all_solvers().entries().size(),
            solver_registry().entries().size() + integrator_registry().entries().size());
  for (const char* effect : {"gravity", "damping", "contact", "friction", "air"}) {
    EXPECT_NO_THROW(effect_registry().find(effect));
  }
  expect_refusal([] { solver_registry().find("xpdb"); },
                 {"unknown solver", "did you mean 'xpbd'?"});
  expect_refusal([] { effect_registry().find("gravty"); }, {"did you mean 'gravity'?"});
}

template <class AnyRegistry>
void expect_bounds_are_enforced(const AnyRegistry& registry) {
  for (const auto& entry : registry.entries()) {
    for (const ParameterSpec& spec : entry.parameters) {
      SCOPED_TRACE(entry.name + "." + spec.name);
      for (const char* bad : {"nan", "inf", "-1e300", "1e300", "", "[1, 2]", "nonsense"}) {
        if (spec.type == ParameterType::kText && spec.choices.empty()) continue;
        expect_refusal(
            [&] {
              parse_parameters(entry.parameters, {{spec.name, bad}}, "x");
            },
            {"x", spec.name});
      }
    }
  }
}

TEST(BuiltInRegistries, RefuseBadValuesOfEveryParameter) {
  expect_bounds_are_enforced(all_solvers());
  expect_bounds_are_enforced(effect_registry());
  expect_bounds_are_enforced(model_registry());
}

}  // namespace
}  // namespace pliant
