#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/patch/patch_fit.h"
#include "pliant/math/error.h"
#include "pliant/scene/reading/patch_file.h"

namespace pliant {
namespace {

struct FitArguments {
  std::string mesh;
  FitOptions options;
  std::string out;
  double scale = 1.0;
  bool overwrite = false;
};

void check_arguments(const FitArguments& arguments) {
  if (!(arguments.scale > 0.0 && std::isfinite(arguments.scale))) {
    throw InputError(fmt::format("--scale is {}: allowed is any number > 0", arguments.scale));
  }
  if (!arguments.overwrite && std::filesystem::exists(arguments.out)) {
    throw InputError(
        fmt::format("'{}' is there already: give --overwrite to replace it", arguments.out));
  }
}

void print_report(const FitArguments& arguments, const TriangleMesh& mesh,
                  const FitReport& report) {
  const double size =
      (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).maxCoeff();
  const double before = static_cast<double>(std::filesystem::file_size(arguments.mesh));
  const double after = static_cast<double>(std::filesystem::file_size(arguments.out));
  fmt::print("{}: {} triangles, {:.0f} bytes\n", arguments.mesh, report.source_triangles, before);
  fmt::print(
      "{}: {} patches, {:.0f} bytes: {:.3g} times fewer triangles, {:.3g} times fewer bytes\n",
      arguments.out, report.triangles, after,
      static_cast<double>(report.source_triangles) / report.triangles, before / after);
  fmt::print("distance: max {:.3g} m, RMS {:.3g} m ({:.2g} % and {:.2g} % of the mesh's size)\n",
             report.max_distance, report.rms_distance, 100.0 * report.max_distance / size,
             100.0 * report.rms_distance / size);
  std::fflush(stdout);
}

int fit(const FitArguments& arguments) {
  check_arguments(arguments);
  TriangleMesh mesh = read_triangle_mesh(arguments.mesh);
  mesh.vertices *= arguments.scale;
  const PatchFit result = fit_patches(mesh, arguments.options, arguments.mesh);
  write_patch_body(arguments.out, result.body);
  print_report(arguments, mesh, result.report);
  return kOk;
}

}  // namespace

void add_fit_command(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "fit", "Fit free-form patches to a closed triangle mesh; say how near they are");
  auto arguments = std::make_shared<FitArguments>();
  command->add_option("mesh", arguments->mesh, "OBJ, STL, PLY, glTF or COLLADA file")
      ->required()
      ->type_name("MESH");
  command
      ->add_option("--triangles", arguments->options.triangles,
                   "How many base triangles to use; 4 or more")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "The body's file, YAML")
      ->required()
      ->type_name("FILE");
  command->add_option("--scale", arguments->scale, "Multiplies the mesh's coordinates first")
      ->type_name("X")
      ->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "Replace FILE where it is there");
  command->callback([arguments, &exit_code] { exit_code = fit(*arguments); });
}

}  // namespace pliant
