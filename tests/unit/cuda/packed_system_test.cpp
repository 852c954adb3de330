#include "cuda/solvers/scenes/packed_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "cuda/solvers/blocks/vertex_blocks.h"
#include "cuda/solvers/matrix/iteration_matrix.h"
#include "cuda/solvers/scenes/joined_system.h"
#include "pliant/math/error.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

TEST(VertexBlocks, OfASolidFillNoMoreMultiprocessorsThanThereAre) {
  for (int particles : {1, 12167, 12672, 12673, 14994, 16896, 16897, 39999, kLargeBody}) {
    const BlockPlan plan = plan_blocks(particles);
    EXPECT_EQ(plan.block % SlicedRowsLayout::kSlice, 0);
    EXPECT_EQ(plan.passes, particles >= kLargeBody ? 2 : 1) << particles;
    const bool fits = (particles + 127) / 128 <= 132;
    if (fits) {
      EXPECT_LE((particles + plan.block - 1) / plan.block, 132) << particles;
    }
  }
}

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
            const int at = s->places[static_cast<std::size_t>(e)].v[a];
            EXPECT_EQ(slot != PackedSimplices::kNoSlot, at < packed.block);
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

constexpr double kTimeStep = 0.005;

struct Packed {
  IterationMatrix prepared;
  PackedSystem system;
};

Packed packed_for(const ProjectiveSystem& system, const DeviceIteration& iteration) {
  Packed result = {prepare_iteration(system, kTimeStep, iteration), pack(system, 32)};
  const Eigen::VectorXd inertia = system.particles.mass / (kTimeStep * kTimeStep);
  result.system.matrix = pack_matrix(result.prepared, iteration, inertia, result.system);
  return result;
}

/// Entries of row k, without those that weigh nothing.
std::map<int, float> entries_of(const SlicedRows& rows, int k) {
  std::map<int, float> entries;
  const int end = sliced_end(rows.begins.data(), k);
  for (int e = sliced(rows.begins.data(), k); e < end; e += SlicedRows::kSlice) {
    const auto at = static_cast<std::size_t>(e);
    if (rows.b[at] != 0.0f) entries[rows.neighbors[at]] = rows.b[at];
  }
  return entries;
}

TEST(PackedMatrix, OfAWeightedIterationHasEveryEntryAndWhatHoldsItsParticle) {
  const ProjectiveSystem system = solid_block({1e5, 0.0, 1000.0});
  const Packed packed = packed_for(system, {DeviceIteration::kLineSearch, 2.0});
  const Eigen::MatrixXd a(packed.prepared.matrix);
  for (int k = 0; k < system.particles.size(); ++k) {
    const int i = packed.system.order[static_cast<std::size_t>(k)];
    if (system.particles.is_fixed(i)) continue;
    const auto entries = entries_of(packed.system.matrix.rows, k);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(a.cols());
    for (const auto& [place, value] : entries) {
      row[packed.system.order[static_cast<std::size_t>(place)]] = value;
    }
    row[i] = a(i, i);
    EXPECT_LE((row - a.row(i).transpose()).cwiseAbs().maxCoeff(), 1e-6 * a(i, i));
    const double held = a.row(i).sum() - system.particles.mass[i] / (kTimeStep * kTimeStep);
    EXPECT_NEAR(packed.system.matrix.held[static_cast<std::size_t>(k)], held, 1e-6 * a(i, i));
  }
}

/// Numbers the levels in which places move, from what `matrix` says of its rows; the first is 0.
std::vector<int> levels_of(const PackedMatrix& matrix, std::size_t places) {
  std::vector<int> levels(places, 0);
  for (int level = 0; level < matrix.levels(); ++level) {
    const auto at = static_cast<std::size_t>(level);
    for (int k = matrix.level_begins[at]; k < matrix.level_begins[at + 1]; ++k) {
      const int place = matrix.members[static_cast<std::size_t>(k)];
      if (place >= 0) levels[static_cast<std::size_t>(place)] = level + 1;
    }
  }
  return levels;
}

TEST(PackedMatrix, OfASweepMeetsEachPairOnceFromTheLaterSide) {
  for (int colors : {0, 3}) {
    const ProjectiveSystem system = solid_block({1e5, 0.0, 1000.0});
    const Packed packed = packed_for(system, {DeviceIteration::kSweep, 1.0, colors});
    const PackedMatrix& matrix = packed.system.matrix;
    EXPECT_EQ(matrix.overflow > 0, colors == 3);
    const auto levels = levels_of(matrix, packed.system.order.size());
    const Eigen::MatrixXd a(packed.prepared.matrix);
    int met = 0;
    for (std::size_t k = 0; k < matrix.members.size(); ++k) {
      if (matrix.members[k] < 0) continue;
      const auto place = static_cast<std::size_t>(matrix.members[k]);
      const int i = packed.system.order[place];
      for (const auto& [neighbor, value] : entries_of(matrix.rows, static_cast<int>(k))) {
        const auto other = static_cast<std::size_t>(neighbor);
        EXPECT_LT(levels[other], levels[place]);
        EXPECT_FLOAT_EQ(value, static_cast<float>(a(i, packed.system.order[other])));
        ++met;
      }
    }
    int wanted = 0;
    const auto& place = packed.system.place;
    for (int i = 0; i < a.rows(); ++i) {
      for (int j = 0; j < i; ++j) {
        const bool differ = levels[static_cast<std::size_t>(place[static_cast<std::size_t>(i)])] !=
                            levels[static_cast<std::size_t>(place[static_cast<std::size_t>(j)])];
        if (a(i, j) != 0.0 && differ) ++wanted;
      }
    }
    EXPECT_EQ(met, wanted);
  }
}

TEST(PackedMatrix, JoinedIsEachOfThemBesideTheOther) {
  const ProjectiveSystem first = spring_net(45, 2, 100.0, 1.0),
                         second = spring_net(70, 4, 50.0, 1.0);
  for (const DeviceIteration& iteration :
       {DeviceIteration{DeviceIteration::kLineSearch, 2.0},
        DeviceIteration{DeviceIteration::kSweep, 1.0, 0},
        DeviceIteration{DeviceIteration::kQuasiNewton, 1.0, 0, 5, 16}}) {
    const Packed a = packed_for(first, iteration), b = packed_for(second, iteration);
    const PackedSystem joined = join({&a.system, &b.system});
    if (iteration.kind == DeviceIteration::kSweep) {
      EXPECT_NE(a.system.matrix.levels(), b.system.matrix.levels()) << "it tests too little";
    }
    const auto rows_by_place = [](const PackedMatrix& matrix, int places) {
      std::map<int, std::map<int, float>> rows;
      const int count = matrix.members.empty() ? places : static_cast<int>(matrix.members.size());
      for (int k = 0; k < count; ++k) {
        const int place = matrix.members.empty() ? k : matrix.members[static_cast<std::size_t>(k)];
        auto entries = entries_of(matrix.rows, k);
        if (place >= 0 && !entries.empty()) rows[place] = entries;
      }
      return rows;
    };
    const int begin = a.system.blocks * a.system.block;
    std::map<int, std::map<int, float>> wanted = rows_by_place(a.system.matrix, 45);
    for (const auto& [place, row] : rows_by_place(b.system.matrix, 70)) {
      for (const auto& [neighbor, value] : row) wanted[begin + place][begin + neighbor] = value;
    }
    EXPECT_EQ(rows_by_place(joined.matrix, joined.particles), wanted);
    EXPECT_EQ(joined.matrix.history, iteration.history);
    EXPECT_EQ(joined.matrix.sweeps, iteration.sweeps);
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
