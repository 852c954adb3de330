// What touches of a sheet, searched for on a GPU: the CPU's contacts to the bit, run after run.
#include <gtest/gtest.h>

#include "cuda/brief.h"
#include "cuda/skip_without_gpu.h"
#include "pliant/effects/self_contact/self_contact.h"
#include "pliant/effects/self_contact/sheet_contact_detection.h"
#include "support/meshes/intersections.h"
#include "support/solvers/sheet_searches.h"
#include "support/worlds/crumpling_sheet.h"

namespace pliant {
namespace {

struct Case {
  std::string name;
  MovingSheet (*make)();
};

class SheetSearchOnGpu : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Sheets, SheetSearchOnGpu,
                         testing::Values(Case{"Folded", [] { return folded_sheet(65, 0.004); }},
                                         Case{"Crumpled", [] { return crumpled_sheet(12, 1); }},
                                         Case{"Triangles", [] { return triangle_soup(400, 2); }},
                                         Case{"Coincident", [] { return coincident_layers(33); }},
                                         Case{"Shot", [] { return shot_sheet(); }}),
                         [](const auto& info) { return info.param.name; });

TEST_P(SheetSearchOnGpu, FindsWhatTheCpuFindsAndRepeatsIt) {
  PLIANT_SKIP_WITHOUT_GPU();
  const MovingSheet sheet = GetParam().make();
  for (int run = 0; run < 2; ++run) {
    SheetTreeSearch cpu = search_of(sheet);
    const auto gpu = make_cuda_sheet_search(cpu);
    const SheetComparison seen = compare(sheet, *gpu, cpu);
    EXPECT_GT(seen.near_pairs, 10u);
    if (run == 0) {
      std::printf("%zu near pairs, %d parts of steps held back\n", seen.near_pairs, seen.held_back);
    }
  }
}

ClothScene scene_on(const std::string& backend) {
  ClothScene scene = crumpling_sheet();
  scene.grid = {0.3, 0.3, 25, 25};
  scene.solver = "chebyshev";
  scene.solver_parameters = {{"iterations", std::to_string(times(30, 6))}, {"backend", backend}};
  return scene;
}

const SheetContactDetection& detection_of(World& world) {
  auto& effect = dynamic_cast<SelfContactEffect&>(*body_of(world).find_effect("self_contact"));
  return dynamic_cast<SheetContactDetection&>(effect.detection());
}

TEST(SheetSearchOnGpuScene, AFallingSheetCrumplesDoesNotPassAndRepeats) {
  PLIANT_SKIP_WITHOUT_GPU();
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const auto world = make_world(scene_on("cuda"));
    for (int step = 0; step < times(120, 50); ++step) {
      ASSERT_TRUE(world->step()) << world->failure();
    }
    EXPECT_EQ(body_of(*world).report.backend, "cuda");
    EXPECT_TRUE(detection_of(*world).has_device());
    const Positions& x = particles_of(*world).x;
    EXPECT_EQ(count_intersections(x, body_of(*world).model->surface_triangles()), 0);
    ends.push_back(x);
    if (is_brief()) continue;
    EXPECT_LT(x.row(2).maxCoeff(), 0.25) << "it still stands";
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(SheetSearchOnGpuScene, GoesWhereTheIterationsDo) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto world = make_world(scene_on("cpu"));
  for (const char* backend : {"cuda", "cpu", "cuda"}) {
    world->set_solver(body_of(*world), solver_registry(), "chebyshev", {{"backend", backend}},
                      "test");
    // A solver that was just made is asked from its second step on at the latest.
    for (int step = 0; step < 2; ++step) ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_EQ(body_of(*world).report.backend, backend);
    EXPECT_EQ(detection_of(*world).has_device(), std::string(backend) == "cuda");
  }
}

}  // namespace
}  // namespace pliant
