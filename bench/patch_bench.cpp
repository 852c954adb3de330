// Surface points a second and thread: found on the implicit surface at rest, and carried by their
// tetrahedra; fit of a large mesh; tetrahedra within it.
#include <benchmark/benchmark.h>

#include "pliant/geometry/meshing/embedding.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "pliant/geometry/patch/patch_fit.h"
#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/geometry/patch/patch_shapes.h"
#include "support/worlds/surfaces.h"

namespace pliant::bench {
namespace {

void points_at_rest(benchmark::State& state) {
  const PatchSurface surface(make_torus_patches(0.1, 0.04));
  std::int64_t points = 0;
  for (auto _ : state) {
    const PatchPolygons polygons = polygonise(surface, 32);
    points += polygons.mesh.vertices.cols();
  }
  state.SetItemsProcessed(points);
}
BENCHMARK(points_at_rest)->Unit(benchmark::kMillisecond);

/// As a step does it: the points of a surface after its tetrahedra moved.
void points_carried(benchmark::State& state) {
  const PatchSurface surface(make_torus_patches(0.1, 0.04));
  const PatchPolygons polygons = polygonise(surface, static_cast<int>(state.range(0)));
  StuffingOptions options;
  options.tetrahedra = 10'000;
  const TetrahedralMesh interior = stuff(polygons.mesh, options);
  const Embedding embedding = embed(polygons.mesh.vertices, interior);
  Eigen::Matrix3Xd points(3, polygons.mesh.vertices.cols());
  for (auto _ : state) {
    carry(embedding, interior.tetrahedra, interior.vertices, points);
    benchmark::DoNotOptimize(points.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * points.cols());
}
BENCHMARK(points_carried)->ArgName("level")->Arg(8)->Arg(32)->Unit(benchmark::kMicrosecond);

void fit_70000_triangles(benchmark::State& state) {
  const TriangleMesh torus = torus_surface(0.1, 0.04, 250, 140);
  for (auto _ : state) {
    const PatchFit fit = fit_patches(torus, {static_cast<int>(state.range(0))});
    state.counters["max_mm"] = 1e3 * fit.report.max_distance;
    state.counters["rms_mm"] = 1e3 * fit.report.rms_distance;
  }
}
BENCHMARK(fit_70000_triangles)->ArgName("patches")->Arg(320)->Arg(2000)->Unit(benchmark::kSecond);

void stuffing(benchmark::State& state) {
  const TriangleMesh torus = torus_surface(0.1, 0.04, 250, 140);
  StuffingOptions options;
  options.tetrahedra = static_cast<int>(state.range(0));
  for (auto _ : state) {
    state.counters["made"] = static_cast<double>(stuff(torus, options).tetrahedra.cols());
  }
}
BENCHMARK(stuffing)
    ->ArgName("tetrahedra")
    ->RangeMultiplier(10)
    ->Range(1'000, 1'000'000)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace pliant::bench

BENCHMARK_MAIN();
