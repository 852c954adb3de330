#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/body/model.h"
#include "pliant/geometry/io/veg_file.h"
#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {

/// The rest shape of a body, what was mended of the mesh that it is from ("" where nothing was),
/// and the material that the mesh's file has, if any.
struct MadeGeometry : BodyGeometry {
  MadeGeometry(BodyGeometry geometry, std::string text = {})  // NOLINT: most have nothing to note
      : BodyGeometry(std::move(geometry)), note(std::move(text)) {}
  std::string note;
  std::optional<FileMaterial> material = {};
};

/// One way to give a body's rest shape: a key under `geometry` in a scene.
struct GeometryKind {
  std::string name;
  std::string description;             ///< one line
  std::vector<ParameterSpec> size;     ///< in the map under its name; empty: a file's path
  std::vector<ParameterSpec> options;  ///< beside its name
  std::vector<std::string> models;     ///< the models it works for
  /// `path` is absolute. Throws InputError without a place.
  std::function<MadeGeometry(const std::string& path, const Parameters& size,
                             const Parameters& options)>
      make;
  /// Vertices or particles that it will make at least, known before any is made, so that a scene
  /// that asks for too many is refused while it costs nothing. None: only the file says.
  std::function<double(const Parameters& size, const Parameters& options)> least_points = {};

  /// Sizes and options.
  std::vector<ParameterSpec> parameters() const;
};

/// `grid` is made from GeometrySpec::grid: its pairs are no parameters of a registry.
const std::vector<GeometryKind>& geometry_kinds();
/// Throws InputError with the names that work for `model` when there is no such kind, or it does
/// not work for it.
const GeometryKind& find_geometry_kind(const std::string& name, const std::string& model);
/// Names of those that work for `model`.
std::vector<std::string> geometry_names(const std::string& model);

/// Shapes of free-form patches: sphere, torus, capsule, rounded_box.
const Registry<PatchBody>& patch_shape_registry();

}  // namespace pliant
