#include "cuda/solvers/packed_system.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cuda/solvers/vertex_blocks.h"
#include "pliant/math/error.h"
#include "support/solver_systems.h"

namespace pliant {
namespace {

TEST(VertexBlocks, AreAPermutationOfCompactGroups) {
  BlockOptions cube;
  cube.cells = {10, 10, 10};
  const TetrahedralMesh mesh = make_block(cube);
  const int block = 64;
  const std::vector<int> order = order_in_blocks(mesh.vertices, block);
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], static_cast<int>(i));
  // 64 vertices of a lattice of spacing 0.1 fill a cube of 0.3; blocks are at most twice as long.
  for (std::size_t begin = 0; begin < order.size(); begin += block) {
    Eigen::AlignedBox3d box;
    for (std::size_t i = begin; i < std::min(order.size(), begin + block); ++i) {
      box.extend(mesh.vertices.col(order[i]));
    }
    EXPECT_LE(box.sizes().maxCoeff(), 0.6 + 1e-12);
  }
}

TEST(PackedSystem, EveryCornerHasOneSlotInItsBlock) {
  for (const StepProblem& problem : step_problems()) {
    const ProjectiveSystem system = problem.make();
    if (!why_not_packed(system).empty()) continue;
    const PackedSystem packed = pack(system, 32);
    for (const PackedSimplices* s : {&packed.tetrahedra, &packed.fibers, &packed.triangles}) {
      std::vector<std::vector<int>> used(static_cast<std::size_t>(packed.blocks));
      for (int b = 0; b < packed.blocks && s->size() > 0; ++b) {
        for (int e = s->begins[static_cast<std::size_t>(b)];
             e < s->begins[static_cast<std::size_t>(b) + 1]; ++e) {
          for (int a = 0; a < s->corners; ++a) {
            const int slot = s->slots[static_cast<std::size_t>(e)].v[a];
            const int at = s->vertices[static_cast<std::size_t>(e)].v[a];
            EXPECT_EQ(slot != PackedSimplices::kNoSlot, at / packed.block == b);
            if (slot != PackedSimplices::kNoSlot) {
              used[static_cast<std::size_t>(b)].push_back(slot);
            }
          }
        }
      }
      for (std::vector<int>& slots : used) {
        std::sort(slots.begin(), slots.end());
        EXPECT_EQ(std::adjacent_find(slots.begin(), slots.end()), slots.end());
        EXPECT_TRUE(slots.empty() || slots.back() < packed.most_slots);
      }
    }
  }
}

TEST(PackedSystem, RefusesElementsWithoutADeviceFormByName) {
  for (const StepProblem& problem : step_problems()) {
    if (problem.name != "solid_with_volume") continue;
    const ProjectiveSystem system = problem.make();
    EXPECT_NE(why_not_packed(system).find("'volume'"), std::string::npos);
    EXPECT_THROW(pack(system, 32), InputError);
    return;
  }
  FAIL() << "the problem is gone";
}

}  // namespace
}  // namespace pliant
