#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/self_contact/sheet_tree_search.h"
#include "pliant/geometry/mesh/grid.h"

/// How long the search for what touches of a folded cloth takes, on the CPU and on the GPU.
namespace pliant::bench {

/// A sheet of 1 m folded over itself, one half 0.9 of the thickness above the other. It slides at
/// 0.1 m/s, and waves of 1 mm run along it.
class FoldedCloth {
 public:
  explicit FoldedCloth(int side)
      : mesh(make_grid({1.0, 1.0, side, side})),
        edge(1.0 / (side - 1)),
        thickness(std::min(0.002, 0.5 * edge)) {}
  Positions at(double time) const {
    Positions x = mesh.vertices;
    for (auto place : x.colwise()) {
      const bool is_upper = place.x() > 0.0;
      if (is_upper) place.head<2>() << -place.x() + 0.1 * time, place.y() + 0.3 * edge;
      const double wave = 0.001 * std::sin(20.0 * place.x() + 30.0 * place.y() + 3.0 * time);
      place.z() = wave + (is_upper ? 0.9 * thickness : 0.0);
    }
    return x;
  }

  static constexpr double kMargin = 0.0005;  // [m]
  TriangleMesh mesh;
  double edge, thickness;  // [m]
};

/// Seconds of each step's search: for what the prediction and what the iterations left meet, and
/// whether that passes.
inline std::vector<double> search_times(const FoldedCloth& cloth, SheetSearch& search, int steps,
                                        std::size_t& found, int& held_back) {
  constexpr double kStep = 0.005;  // [s]
  Particles particles(cloth.mesh.vertices, Eigen::VectorXd::Ones(cloth.mesh.vertices.cols()));
  std::vector<double> times;
  for (int s = 0; s < steps; ++s) {
    const Positions start = cloth.at(s * kStep), end = cloth.at((s + 1) * kStep);
    Positions predicted = end;
    predicted.row(2).array() -= 9.81 * kStep * kStep;
    Positions x = end;
    const auto begin = std::chrono::steady_clock::now();
    search.find(start, predicted);
    SheetNearPairs near_pairs = search.find(start, end);
    found = near_pairs.size();
    if (!search.limit_displacement(particles, x, near_pairs)) ++held_back;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    times.push_back(took.count());
  }
  return times;
}

inline void time_search(const FoldedCloth& cloth, const char* where, SheetSearch& search,
                        int steps) {
  std::size_t found = 0;
  int held_back = 0;
  const std::vector<double> times = search_times(cloth, search, steps, found, held_back);
  std::vector<double> rest(times.begin() + 1, times.end());
  std::sort(rest.begin(), rest.end());
  double sum = 0.0;
  for (const double time : rest) sum += time;
  fmt::print("{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f}\n", cloth.mesh.vertices.cols(), where,
             threads(), found, held_back, 1e3 * times.front(),
             1e3 * sum / static_cast<double>(rest.size()), 1e3 * rest.front(), 1e3 * rest.back());
  const SheetSearchCost cost = search.cost();
  if (cost.collections > 0) {
    const double each = 1e3 / static_cast<double>(times.size());
    fmt::print(
        "# a step: transfers {:.3f}, follow {:.3f}, collect {:.3f} ({} times in all), look {:.3f}, "
        "gather {:.3f} ms; at last {} candidates, {} awake, {} near\n",
        each * cost.transfers, each * cost.follow, each * cost.collect, cost.collections,
        each * cost.look, each * cost.gather, cost.candidates, cost.awake, cost.near);
  }
  std::fflush(stdout);
}

/// Of cloths of side x side vertices; `steps` after the first one, which collects candidates.
inline void search(const std::vector<int>& sides, int threads, int steps, bool on_cpu) {
  set_threads(threads);
  fmt::print(
      "vertices,search,threads,contacts,held_back,first_milliseconds,mean_milliseconds,least,"
      "most\n");
  for (const int side : sides) {
    const FoldedCloth cloth(side);
    SheetTreeSearch cpu(cloth.mesh.vertices, cloth.mesh.triangles, cloth.thickness,
                        FoldedCloth::kMargin);
    time_search(cloth, "cuda", *make_cuda_sheet_search(cpu), steps + 1);
    if (on_cpu) time_search(cloth, "cpu", cpu, steps + 1);
  }
}

}  // namespace pliant::bench
