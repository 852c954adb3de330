// What a large scene takes from the heap.
#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/core/parameters.h"
#include "pliant/math/error.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "resources/heap.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

constexpr int kNodes = 200 * 200;

/// A hanging cloth of the default fabric, bending included.
std::unique_ptr<World> hanging(const std::string& solver) {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 200, 200};
  scene.fixed = {0, 199};
  scene.solver = solver;
  scene.solver_parameters = with_iterations(solver, 5);
  scene.time_step = is_explicit(solver) ? 1e-5 : 1e-3;
  scene.effects = {{"gravity", {}}, {"damping", {}}};
  return make_world(scene);
}

class Memory : public EverySolver {};

/// Those that keep no matrix.
INSTANTIATE_TEST_SUITE_P(Solvers, Memory, testing::Values("verlet", "xpbd"), test_name_of);

// From its geometry to some steps.
TEST_P(Memory, PeakIsBelowOneKilobyteANode) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const HeapWatch watch;
  const auto world = hanging(solver());
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
  ASSERT_EQ(particles_of(*world).size(), kNodes);
  RecordProperty("bytes_per_node", std::to_string(watch.peak() / kNodes));
  EXPECT_LT(watch.peak() / kNodes, 1024u);
}

/// Without those that keep a factor or a Hessian, which grow faster than the number of nodes.
std::vector<std::string> solvers_without_a_factor() {
  std::vector<std::string> names = cloth_solvers();
  const auto factors = [](const std::string& solver) {
    return solver == "direct" || solver == "lbfgs" || solver == "newton";
  };
  names.erase(std::remove_if(names.begin(), names.end(), factors), names.end());
  return names;
}

class MemoryKept : public EverySolver {};
INSTANTIATE_TEST_SUITE_P(Solvers, MemoryKept, testing::ValuesIn(solvers_without_a_factor()),
                         test_name_of);

TEST_P(MemoryKept, IsBelowOneKilobyteANode) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const HeapWatch watch;
  const auto world = hanging(solver());
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
  RecordProperty("bytes_per_node", std::to_string(watch.in_use() / kNodes));
  EXPECT_LT(watch.in_use() / kNodes, 1024u);
}

struct HugeGeometry {
  const char *kind, *model;
  ParameterText size, options;
};

std::ostream& operator<<(std::ostream& stream, const HugeGeometry& given) {
  return stream << given.model << " of a " << given.kind;
}

/// Each within the ranges of its fields, and too large as a whole.
const HugeGeometry kHugeGeometries[] = {
    {"torus",
     "patch",
     {{"ring", "1"}, {"tube", "0.5"}, {"around", "1000"}, {"across", "1000"}},
     {{"surface_level", "256"}}},
    {"torus",
     "viscoelastic",
     {{"ring", "1"}, {"tube", "0.5"}, {"around", "1000"}, {"across", "1000"}},
     {}},
    {"capsule",
     "patch",
     {{"radius", "1"}, {"length", "1"}, {"around", "1000"}, {"rings", "1000"}},
     {}},
    {"capsule",
     "viscoelastic",
     {{"radius", "1"}, {"length", "1"}, {"around", "1000"}, {"rings", "1000"}},
     {}},
    {"rounded_box", "patch", {{"size", "[1, 1, 1]"}, {"radius", "0.1"}, {"segments", "100"}}, {}},
    {"rounded_box",
     "viscoelastic",
     {{"size", "[1, 1, 1]"}, {"radius", "0.1"}, {"segments", "100"}},
     {}},
    {"sphere", "patch", {{"radius", "1"}, {"level", "4"}}, {{"surface_level", "256"}}},
    {"sphere", "patch", {{"radius", "1"}}, {{"tetrahedra", "50"}, {"contact_spacing", "1e-9"}}},
    {"sphere", "patch", {{"radius", "1"}}, {{"cell_size", "1e-9"}}},
    {"sphere", "patch", {{"radius", "1"}}, {{"cell_size", "0.0134"}}},
    {"sphere", "viscoelastic", {{"radius", "1"}}, {{"spacing", "1e-9"}}},
    {"sphere", "viscoelastic", {{"radius", "1"}, {"level", "4"}}, {{"surface_level", "256"}}},
    {"block", "viscoelastic", {{"size", "[1, 1, 1]"}}, {{"spacing", "1e-9"}}},
    {"block", "patch", {{"size", "[1, 1, 1]"}, {"cells", "[5000, 5000, 5000]"}}, {}},
    {"block",
     "patch",
     {{"size", "[1, 1, 1]"}, {"cells", "[2, 2, 2]"}},
     {{"contact_spacing", "1e-9"}}},
    {"tube",
     "cloth",
     {{"radius", "1"}, {"length", "1"}, {"around", "100000"}, {"along", "100000"}},
     {}},
    {"holed_sheet",
     "cloth",
     {{"width", "1"}, {"height", "1"}, {"hole", "0.1"}, {"side", "100000"}, {"rings", "100000"}},
     {}},
};

class HugeGeometries : public testing::TestWithParam<HugeGeometry> {};
INSTANTIATE_TEST_SUITE_P(All, HugeGeometries, testing::ValuesIn(kHugeGeometries));

TEST_P(HugeGeometries, AreRefusedBeforeTheyTakeMemory) {
  const HugeGeometry& given = GetParam();
  const GeometryKind& kind = find_geometry_kind(given.kind, given.model);
  const Parameters size = parse_parameters(kind.size, given.size, "size");
  const Parameters options = parse_parameters(kind.options, given.options, "options");
  const HeapWatch watch;
  EXPECT_THROW(kind.make("", size, options), InputError);
  if (HeapWatch::works()) {
    EXPECT_LT(watch.peak(), 100e6);
  }
}

}  // namespace
}  // namespace pliant
