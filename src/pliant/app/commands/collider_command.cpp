#include <fmt/format.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>

#include "pliant/app/commands/commands.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/repair/collider_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

struct ColliderArguments {
  std::string mesh;
  std::string kind = "auto";
  ColliderOptions options;
  double scale = 1.0;
  std::optional<std::string> out;
  bool overwrite = false;
};

int show_collider(ColliderArguments arguments) {
  arguments.options.kind = find_collider(arguments.kind);
  if (arguments.out && !arguments.overwrite && std::filesystem::exists(*arguments.out)) {
    throw InputError(
        fmt::format("'{}' is there already: give --overwrite to replace it", *arguments.out));
  }
  const MeshCollider collider = load_mesh_collider(
      arguments.mesh, Eigen::Vector3d::Constant(arguments.scale), arguments.options);
  const TriangleMesh surface = collider.shape->surface();
  const Eigen::Vector3d size = collider.shape->bounds().sizes();
  fmt::print("{}: {}\n", arguments.mesh, collider.note);
  fmt::print("{:.4g} x {:.4g} x {:.4g} m, {:.4g} m^3, samples {:.3g} m apart\n", size[0], size[1],
             size[2], signed_volume(surface), collider.shape->voxel_size());
  if (arguments.out) {
    write_ply(*arguments.out, surface);
    fmt::print("written: {} ({} triangles)\n", *arguments.out, surface.triangles.cols());
  }
  return kOk;
}

}  // namespace

void add_collider_command(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "collider", "Tell what solid a mesh becomes as an obstacle or a robot's link, and why");
  auto arguments = std::make_shared<ColliderArguments>();
  command->add_option("mesh", arguments->mesh, "OBJ, STL, PLY, glTF or COLLADA")
      ->required()
      ->type_name("FILE");
  command->add_option("--kind", arguments->kind, "auto, exact, repaired, convex or thick_shell")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--voxel-size", arguments->options.voxel_size,
                      "Spacing of the distance samples [m]; 0 chooses");
  command->add_option("--thickness", arguments->options.thickness,
                      "Of a thick shell [m]; 0: two voxels");
  command->add_option("--scale", arguments->scale, "Factor on the mesh's lengths")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Write the solid's surface to this PLY file")
      ->type_name("FILE");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it is there");
  command->callback([arguments, &exit_code] { exit_code = show_collider(*arguments); });
}

}  // namespace pliant
