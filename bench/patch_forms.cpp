// Free-form patches of two forms, fitted to a mesh over the same base: the paper's, quadrics of
// each triangle that are summed, and ours, one quadric an edge that both its triangles share.
//   patch_forms MESH [TRIANGLES...]
#include <fmt/format.h>

#include <cstdlib>
#include <iterator>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/patch/summed_patches.h"
#include "pliant/math/error.h"
#include "pliant/scene/reading/patch_file.h"

namespace pliant::bench {
namespace {

constexpr int kDigits = 8;  // about as many as fit_patches() needs

/// As patch_body_text() writes them, the quadrics by triangle.
std::string text_of(const SummedPatches& body) {
  std::string text = "vertices:\n";
  const auto out = std::back_inserter(text);
  const auto add = [&](const auto& numbers) {
    for (Eigen::Index k = 0; k < numbers.size(); ++k) {
      fmt::format_to(out, "{}{:.{}g}", k == 0 ? "" : ", ", numbers[k], kDigits);
    }
  };
  for (const Eigen::Vector3d v : body.base.vertices.colwise()) {
    text += "- [";
    add(v);
    text += "]\n";
  }
  text += "triangles:\n";
  for (std::size_t t = 0; t < body.quadrics.size(); ++t) {
    const auto c = body.base.triangles.col(static_cast<Eigen::Index>(t));
    fmt::format_to(out, "- {{vertices: [{}, {}, {}], quadrics: [", c[0], c[1], c[2]);
    for (const Quadric& quadric : body.quadrics[t]) {
      text += &quadric == body.quadrics[t].data() ? "[" : ", [";
      add(quadric);
      text += "]";
    }
    text += "]}\n";
  }
  return text;
}

/// In percent of the mesh's size.
void print(const std::string& form, std::size_t quadrics, std::size_t bytes, double largest,
           double rms, double gap, double rms_gap) {
  fmt::print("| {} | {} | {:.0f} | {:.2f} | {:.3f} | {:.2f} | {:.3f} |\n", form, quadrics,
             static_cast<double>(bytes) / 1e3, largest, rms, gap, rms_gap);
  std::fflush(stdout);
}

void compare_forms(const TriangleMesh& mesh, int triangles) {
  const double percent =
      100.0 / (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).maxCoeff();
  const PatchFit fit = fit_patches(mesh, {triangles});
  const TriangleMesh& base = fit.body.base;
  fmt::print(
      "\n{} triangles\n\n| form | quadrics | kB | greatest [%] | RMS [%] | widest gap [%] | "
      "RMS gap [%] |\n|---|---|---|---|---|---|---|\n",
      base.triangles.cols());
  print("one quadric an edge", fit.body.quadrics.size(), patch_body_text(fit.body).size(),
        percent * fit.report.max_distance, percent * fit.report.rms_distance, 0.0, 0.0);
  const std::vector<FitSample> samples = samples_of(mesh, base);
  for (const int each : {1, 2, 3, 4}) {
    const SummedPatches body = fit_summed_patches(base, samples, each);
    const SummedReport report = compare(body, mesh);
    print(fmt::format("up to {} a triangle, summed", each),
          static_cast<std::size_t>(report.quadrics), text_of(body).size(),
          percent * report.max_distance, percent * report.rms_distance, percent * report.widest_gap,
          percent * report.rms_gap);
  }
}

int run(int count, char** words) {
  if (count < 2) {
    fmt::print(stderr, "usage: patch_forms MESH [TRIANGLES...]\n");
    return 2;
  }
  const TriangleMesh mesh = read_triangle_mesh(words[1]);
  std::vector<int> sizes;
  for (int k = 2; k < count; ++k) sizes.push_back(std::atoi(words[k]));
  if (sizes.empty()) sizes = {300, 400};
  for (const int triangles : sizes) compare_forms(mesh, triangles);
  return 0;
}

}  // namespace
}  // namespace pliant::bench

int main(int count, char** words) {
  try {
    return pliant::bench::run(count, words);
  } catch (const pliant::InputError& error) {
    fmt::print(stderr, "patch_forms: {}\n", error.what());
    return 2;
  }
}
