#pragma once

#include <limits>
#include <vector>

#include "cuda/effects/sheet_candidates.h"
#include "pliant/effects/self_contact/sheet_tree_search.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// Collects the candidates of a sheet by an executor, as SheetTreeSearch::collect().
template <class Executor>
class SheetCollector {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  SheetCollector(Executor& executor, const SheetTreeSearch& cpu)
      : thickness_(cpu.thickness()),
        reach_(0.5 * (cpu.thickness() + cpu.margin())),
        mean_edge_(cpu.mesh().mean_edge),
        vertices_(cpu.mesh().vertices()) {
    const SheetMesh& mesh = cpu.mesh();
    set(executor, rest_, mesh.rest);
    set(executor, begins_, mesh.begins);
    set(executor, neighbors_, mesh.neighbors);
    triangle_tree_.take(executor, cpu.triangle_tree());
    edge_tree_.take(executor, cpu.edge_tree());
    std::vector<int> corners, ends;
    for (const int t : cpu.triangle_tree().order()) {
      for (int k = 0; k < 3; ++k) corners.push_back(mesh.triangles(k, t));
    }
    for (const int e : cpu.edge_tree().order()) {
      for (int k = 0; k < 2; ++k) ends.push_back(mesh.edges(k, e));
    }
    set(executor, corners_, corners);
    set(executor, ends_, ends);
    set(executor, edge_numbers_, cpu.edge_tree().order());
    executor.synchronize();  // what is uploaded ends here
  }

  /// For the paths between `places`. The tally's pairs are 0.
  SheetCandidates collect(Executor& executor, const sheet_kernels::SheetPlaces& places,
                          Array<SheetTally>& tally) {
    using namespace sheet_kernels;
    executor.launch(vertices_, BeginCollection{places, mean_edge_});
    enclose(executor, places);
    const DeviceTreeView triangles = triangle_tree_.view(), edges = edge_tree_.view();
    const int rows = vertices_ + edges.size;
    int* counts = rows_.counts(rows);
    executor.launch(rows_.size(), ClearCounts{counts});
    CollectPairs around{
        {triangles, edges, corners_.data(), ends_.data(), edge_numbers_.data(), vertices_},
        places,
        reach_,
        counts,
        nullptr,
        nullptr};
    executor.launch(rows, around);
    executor.launch((rows + AddCounts::kRun - 1) / AddCounts::kRun,
                    AddCounts{counts, rows, tally.data()});
    expect_countable(executor, tally);
    around.begins = rows_.sum(executor);
    const int vertex_pairs = rows_.before(executor, vertices_), pairs = rows_.total(executor);
    make_room(static_cast<std::size_t>(pairs));
    around.particles = particles_.data();
    executor.launch(rows, around);
    const SheetCandidates candidates = {particles_.data(), thicknesses_.data(), wakes_.data(),
                                        gaps_.data(),      vertex_pairs,        pairs};
    const SheetJoints joints = {rest_.data(), begins_.data(), neighbors_.data()};
    executor.launch(pairs, BeginCandidates{candidates, joints, places.start, thickness_});
    return candidates;
  }

 private:
  template <class T>
  static void set(Executor& executor, Array<T>& array, const std::vector<T>& values) {
    if (values.empty()) return;
    array.resize(values.size());
    executor.upload(array, values.data(), values.size());
  }

  void enclose(Executor& executor, const sheet_kernels::SheetPlaces& places) {
    using namespace sheet_kernels;
    executor.launch(triangle_tree_.view().size,
                    EncloseSimplices<3>{places, reach_, corners_.data(), triangle_tree_.boxes()});
    executor.launch(edge_tree_.view().size,
                    EncloseSimplices<2>{places, reach_, ends_.data(), edge_tree_.boxes()});
    triangle_tree_.refit(executor);
    edge_tree_.refit(executor);
  }

  static void expect_countable(Executor& executor, const Array<SheetTally>& tally) {
    SheetTally counted;
    executor.download(&counted, tally, 1);
    if (counted.pairs > static_cast<SharedCount>(std::numeric_limits<int>::max())) {
      throw DeviceFailure("more triangles and edges lie near each other than can be counted");
    }
  }

  void make_room(std::size_t pairs) {
    grow(particles_, pairs);
    grow(thicknesses_, pairs);
    grow(wakes_, pairs);
    grow(gaps_, pairs);
  }

  double thickness_, reach_, mean_edge_;  // [m]
  int vertices_;
  // The sheet at rest; simplices by their ranks in the trees.
  Array<Double3> rest_;
  Array<int> begins_, neighbors_, corners_, ends_, edge_numbers_;
  DeviceTree<Executor> triangle_tree_, edge_tree_;
  CountedRows<Executor> rows_;
  Array<Int4> particles_;
  Array<double> thicknesses_, wakes_;
  Array<SheetGap> gaps_;
};

}  // namespace pliant
