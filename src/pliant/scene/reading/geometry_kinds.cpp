#include "pliant/scene/reading/geometry_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/geometry/mesh/sheet_meshes.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "pliant/geometry/meshing/surface_samples.h"
#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/geometry/patch/patch_samples.h"
#include "pliant/geometry/repair/body_surface.h"
#include "pliant/math/error.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "pliant/models/reduced/files/scene_example.h"
#include "pliant/models/viscoelastic/interior_samples.h"
#include "pliant/scene/reading/patch_file.h"
#include "pliant/scene/reading/scene_readers.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

// Contact points lie this share of a boundary edge apart unless the scene says otherwise.
constexpr double kContactSpacing = 0.75;
// Of a rigid body, this share of its size.
constexpr double kRigidContactSpacing = 0.05;

std::vector<ParameterSpec> interior_parameters() {
  return {
      integer_parameter("tetrahedra", "3000", 1, kMaxTetrahedra, "about how many fill the body"),
      number_parameter("cell_size", "m", "0", 0.0, 1e6,
                       "of the lattice they are cut from; 0: found from `tetrahedra`"),
      number_parameter("hole_size", "m", "-1", -1.0, 1e6,
                       "widest hole of the surface that is closed; negative: one cell")};
}

ParameterSpec spacing_parameter() {
  return number_parameter("contact_spacing", "m", "0", 0.0, 1e6,
                          "of the points that touch; 0: three quarters of a boundary edge");
}

ParameterSpec level_parameter() {
  return integer_parameter("surface_level", "6", 1, kMaxPatchLevel,
                           "each patch is drawn with level^2 triangles");
}

/// A point of the lattice has 24 tetrahedra of four points each, so that six come on a point; half
/// of that is what no body goes below. How many cells of a given size make is not known yet.
double least_filled(const Parameters&, const Parameters& options) {
  return options.number("cell_size") > 0.0 ? 0.0 : options.integer("tetrahedra") / 12.0;
}

StuffingOptions stuffing_options(const Parameters& options) {
  StuffingOptions result;
  result.cell_size = options.number("cell_size");
  result.tetrahedra = options.integer("tetrahedra");
  result.hole_size = options.number("hole_size");
  return result;
}

TriangleMesh boundary(const TetrahedralMesh& mesh) {
  TriangleMesh all{mesh.vertices, boundary_triangles(mesh)};
  std::vector<int> place(static_cast<std::size_t>(mesh.vertices.cols()), -1);
  TriangleMesh result;
  result.triangles.resize(3, all.triangles.cols());
  std::vector<Eigen::Vector3d> vertices;
  for (Eigen::Index k = 0; k < all.triangles.size(); ++k) {
    int& index = place[static_cast<std::size_t>(all.triangles.data()[k])];
    if (index < 0) {
      index = static_cast<int>(vertices.size());
      vertices.emplace_back(mesh.vertices.col(all.triangles.data()[k]));
    }
    result.triangles.data()[k] = index;
  }
  result.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    result.vertices.col(static_cast<Eigen::Index>(v)) = vertices[v];
  }
  return result;
}

double contact_spacing(const Parameters& options, const TetrahedralMesh& interior) {
  const double given = options.number("contact_spacing");
  return given > 0.0 ? given : kContactSpacing * mean_edge_length(boundary(interior));
}

BodyGeometry filled(const TriangleMesh& surface, const Parameters& options) {
  BodyGeometry geometry;
  geometry.mesh = surface;
  geometry.tetrahedra = stuff(surface, stuffing_options(options));
  geometry.contact_points = sample_surface(surface, contact_spacing(options, *geometry.tetrahedra));
  return geometry;
}

BodyGeometry filled(const PatchBody& body, const Parameters& options) {
  validate_solid(body, "patches");
  const PatchSurface surface(body);
  BodyGeometry geometry;
  geometry.mesh = polygonise(surface, options.integer("surface_level")).mesh;
  geometry.tetrahedra = stuff(geometry.mesh, stuffing_options(options));
  geometry.contact_points =
      sample_points(surface, contact_spacing(options, *geometry.tetrahedra)).points;
  return geometry;
}

BodyGeometry from_tetrahedra(TetrahedralMesh mesh, const Parameters& options) {
  BodyGeometry geometry;
  geometry.mesh = boundary(mesh);
  geometry.contact_points = sample_surface(geometry.mesh, contact_spacing(options, mesh));
  geometry.tetrahedra = std::move(mesh);
  return geometry;
}

BodyGeometry from_reduced(ReducedModel model, const Parameters& options) {
  BodyGeometry geometry = from_tetrahedra(model.mesh, options);
  if (model.surface.triangles.cols() > 0) {
    geometry.mesh = model.surface;
    geometry.contact_points = sample_surface(geometry.mesh, contact_spacing(options, model.mesh));
  }
  geometry.reduced = std::make_shared<const ReducedModel>(std::move(model));
  return geometry;
}

PatchBody scaled(PatchBody body, double scale) {
  body.base.vertices *= scale;
  // Q(p)³ is a height: Q'(s p) = s^(1/3) Q(p).
  const double share = std::cbrt(scale);
  for (Quadric& quadric : body.quadrics)
    quadric = share * placed(quadric, Eigen::Vector3d::Zero(), scale);
  return body;
}

TriangleMesh read_scaled_mesh(const std::string& path, const Parameters& options) {
  TriangleMesh mesh = read_triangle_mesh(path);
  mesh.vertices *= options.number("scale");
  return mesh;
}

/// The surface of a body with an inside, mended where that is possible; `note` says of what.
TriangleMesh read_body_surface(const std::string& path, const Parameters& options,
                               std::string& note, bool keep_holes = false) {
  const TriangleMesh mesh = read_scaled_mesh(path, options);
  return with_place("mesh '" + path + "'",
                    [&] { return make_body_surface(mesh, note, keep_holes); });
}

double rigid_contact_spacing(const TriangleMesh& surface) {
  const Eigen::Vector3d size =
      surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  return kRigidContactSpacing * size.norm();
}

GeometryKind shape_kind(const Registry<PatchBody>::Entry& shape) {
  std::vector<ParameterSpec> options = interior_parameters();
  options.push_back(level_parameter());
  options.push_back(spacing_parameter());
  return {shape.name,
          shape.description + ", as free-form patches",
          shape.parameters,
          options,
          {"patch"},
          [&shape](const std::string&, const Parameters& size, const Parameters& options) {
            return filled(*shape.make(size), options);
          },
          least_filled};
}

std::vector<ParameterSpec> particle_parameters() {
  return {integer_parameter("particles", "2000", 1, 2e6, "about how many fill the body"),
          number_parameter("spacing", "m", "0", 0.0, 1e6,
                           "between particles; 0: found from `particles`")};
}

/// `particles` are met to some percent. How many a given spacing makes is not known yet.
double least_particles(const Parameters&, const Parameters& options) {
  return options.number("spacing") > 0.0 ? 0.0 : 0.8 * options.integer("particles");
}

/// A body of particles.
BodyGeometry with_particles(TriangleMesh surface, const Parameters& options) {
  double spacing = options.number("spacing");
  if (spacing == 0.0) {
    const int particles = options.integer("particles");
    const double volume = std::abs(signed_volume(surface));
    spacing = std::cbrt(volume / particles);
    const double least = least_particle_spacing(surface);
    if (spacing > 0.0 && spacing < least) {
      throw InputError(fmt::format("particles is {}: allowed for this shape is [1, {:.0f}]",
                                   particles, std::floor(volume / (least * least * least))));
    }
  }
  BodyGeometry geometry;
  InteriorSamples samples = sample_interior(surface, spacing);
  geometry.mesh = std::move(surface);
  geometry.interior_points = std::move(samples.points);
  geometry.volume = samples.volume;
  return geometry;
}

GeometryKind particle_shape_kind(const Registry<PatchBody>::Entry& shape) {
  std::vector<ParameterSpec> options = particle_parameters();
  options.push_back(level_parameter());
  return {shape.name,
          shape.description + ", filled with particles",
          shape.parameters,
          options,
          {"viscoelastic"},
          [&shape](const std::string&, const Parameters& size, const Parameters& options) {
            const std::unique_ptr<PatchBody> body = shape.make(size);
            return with_particles(
                polygonise(PatchSurface(*body), options.integer("surface_level")).mesh, options);
          },
          least_particles};
}

GeometryKind particle_block_kind() {
  return {"block",
          "a box filled with particles",
          {vector_parameter("size", "m", "", kMaxShapeSize, "full extents")},
          particle_parameters(),
          {"viscoelastic"},
          [](const std::string&, const Parameters& size, const Parameters& options) {
            return with_particles(Box(size.vector("size")).surface(), options);
          },
          least_particles};
}

GeometryKind block_kind() {
  return {"block",
          "a box of five tetrahedra a cell",
          {vector_parameter("size", "m", "", kMaxShapeSize, "full extents"),
           vector_parameter("cells", "", "", kMaxTetrahedra,
                            "cells along x, y, z, whole numbers; each is five tetrahedra")},
          {spacing_parameter()},
          {"patch"},
          [](const std::string&, const Parameters& size, const Parameters& options) {
            const Eigen::Vector3d& cells = size.vector("cells");
            if (cells != cells.array().round().matrix()) {
              throw InputError(fmt::format("cells are {}, {}, {}: allowed are whole numbers >= 1",
                                           cells[0], cells[1], cells[2]));
            }
            return from_tetrahedra(make_block({size.vector("size"), cells.cast<int>()}), options);
          },
          [](const Parameters& size, const Parameters&) {
            return (size.vector("cells").array() + 1.0).prod();
          }};
}

/// A rigid body: its closed surface, the points of it that touch, and its volume's moments where
/// the shape gives them.
BodyGeometry rigid(TriangleMesh surface, std::optional<VolumeMoments> moments,
                   const Parameters& options) {
  BodyGeometry geometry;
  const double given = options.number("contact_spacing");
  geometry.contact_points =
      sample_surface(surface, given > 0.0 ? given : rigid_contact_spacing(surface));
  geometry.cones = std::make_shared<NormalCones>(surface, geometry.contact_points);
  geometry.mesh = std::move(surface);
  geometry.moments = std::move(moments);
  return geometry;
}

/// Of a shape that is round, whose points that touch lie on itself and not on its triangles.
BodyGeometry rigid(const Shape& shape, std::optional<VolumeMoments> moments,
                   const Parameters& options) {
  BodyGeometry geometry = rigid(shape.surface(), std::move(moments), options);
  geometry.contact_normals.resize(3, geometry.contact_points.cols());
  geometry.cones.reset();
  for (Eigen::Index i = 0; i < geometry.contact_points.cols(); ++i) {
    const SurfacePoint found = shape.query(geometry.contact_points.col(i));
    geometry.contact_points.col(i) -= found.distance * found.normal;
    geometry.contact_normals.col(i) = found.normal;
  }
  return geometry;
}

ParameterSpec rigid_spacing_parameter() {
  return number_parameter("contact_spacing", "m", "0", 0.0, 1e6,
                          "of the points that touch obstacles; 0: a twentieth of the body's size");
}

void add_rigid_kinds(std::vector<GeometryKind>& kinds) {
  const std::vector<ParameterSpec> spacing = {rigid_spacing_parameter()};
  const ParameterSpec radius = positive_parameter("radius", "m", "", kMaxShapeSize, "of the shape");
  const ParameterSpec length = positive_parameter("length", "m", "", kMaxShapeSize,
                                                  "along z, of a capsule without its ends");
  using Size = const Parameters&;
  kinds.push_back({"box",
                   "a box about the origin",
                   {vector_parameter("size", "m", "", kMaxShapeSize, "full extents")},
                   spacing,
                   {"rigid"},
                   [](const std::string&, Size size, Size options) {
                     const Box box(size.vector("size"));
                     return rigid(box.surface(), box_moments(box.size()), options);
                   }});
  kinds.push_back({"sphere",
                   "a sphere about the origin",
                   {radius},
                   spacing,
                   {"rigid"},
                   [](const std::string&, Size size, Size options) {
                     const Sphere sphere(size.number("radius"));
                     return rigid(sphere, sphere_moments(sphere.radius()), options);
                   }});
  kinds.push_back({"capsule",
                   "a capsule along z about the origin",
                   {radius, length},
                   spacing,
                   {"rigid"},
                   [](const std::string&, Size size, Size options) {
                     const Capsule capsule(size.number("radius"), size.number("length"));
                     return rigid(capsule, capsule_moments(capsule.radius(), capsule.length()),
                                  options);
                   }});
  kinds.push_back({"cylinder",
                   "a cylinder along z about the origin",
                   {radius, length},
                   spacing,
                   {"rigid"},
                   [](const std::string&, Size size, Size options) {
                     const Cylinder cylinder(size.number("radius"), size.number("length"));
                     return rigid(cylinder, cylinder_moments(cylinder.radius(), cylinder.length()),
                                  options);
                   }});
  kinds.push_back({"mesh",
                   "path of a closed triangle mesh: OBJ, STL, PLY, glTF or COLLADA",
                   {},
                   joined({scale_parameter()}, spacing),
                   {"rigid"},
                   [](const std::string& path, Size, Size options) -> MadeGeometry {
                     std::string note;
                     TriangleMesh mesh = read_body_surface(path, options, note);
                     return {rigid(std::move(mesh), std::nullopt, options), note};
                   }});
}

GeometryKind tetrahedral_mesh_kind() {
  return {"tetrahedral_mesh",
          "path of tetrahedra: Gmsh (.msh), TetGen (.node, .ele) or Vega (.veg)",
          {},
          joined({scale_parameter()}, {spacing_parameter()}),
          {"patch"},
          [](const std::string& path, const Parameters&, const Parameters& options) {
            MeshWithMaterial file = read_tetrahedral_file(path);
            file.mesh.vertices *= options.number("scale");
            MadeGeometry geometry = from_tetrahedra(std::move(file.mesh), options);
            geometry.material = std::move(file.material);
            return geometry;
          }};
}

GeometryKind reduced_model_kind() {
  return {"reduced_model",
          "path of a reduced body, as `pliant reduce` writes it",
          {},
          {spacing_parameter()},
          {"reduced"},
          [](const std::string& path, const Parameters&, const Parameters& options) {
            return from_reduced(read_reduced_model(path), options);
          }};
}

GeometryKind example_kind() {
  return {"example",
          "a body of ours, reduced when the scene is read",
          scene_example_parameters(),
          {spacing_parameter()},
          {"reduced"},
          [](const std::string&, const Parameters& size, const Parameters& options) {
            return from_reduced(reduce_scene_example(size), options);
          }};
}

GeometryKind tube_kind() {
  return {"tube",
          "an open tube along z about the origin, as a sleeve or a shirt is",
          {positive_parameter("radius", "m", "", 1e6, "of the tube"),
           positive_parameter("length", "m", "", 1e6, "of the tube"),
           integer_parameter("around", "24", 3, 1e5, "cells around"),
           integer_parameter("along", "12", 1, 1e5, "cells along")},
          {},
          {"cloth"},
          [](const std::string&, const Parameters& size, const Parameters&) {
            BodyGeometry geometry;
            geometry.mesh = make_tube({size.number("radius"), size.number("length"),
                                       size.integer("around"), size.integer("along")});
            return geometry;
          },
          [](const Parameters& size, const Parameters&) {
            return size.integer("around") * (size.integer("along") + 1.0);
          }};
}

GeometryKind holed_sheet_kind() {
  return {"holed_sheet",
          "a rectangle in the x-y plane with a round hole about the origin",
          {positive_parameter("width", "m", "", 1e6, "along x"),
           positive_parameter("height", "m", "", 1e6, "along y"),
           positive_parameter("hole", "m", "", 1e6,
                              "radius of the hole, less than half of the shorter side"),
           integer_parameter("side", "12", 1, 1e5, "cells along each side"),
           integer_parameter("rings", "8", 1, 1e5, "cells from the hole to the sides")},
          {},
          {"cloth"},
          [](const std::string&, const Parameters& size, const Parameters&) {
            BodyGeometry geometry;
            geometry.mesh =
                make_holed_sheet({size.number("width"), size.number("height"), size.number("hole"),
                                  size.integer("side"), size.integer("rings")});
            return geometry;
          },
          [](const Parameters& size, const Parameters&) {
            return 4.0 * size.integer("side") * (size.integer("rings") + 1.0);
          }};
}

std::vector<GeometryKind> make_kinds() {
  std::vector<GeometryKind> kinds;
  const std::vector<ParameterSpec> scale = {scale_parameter()};
  kinds.push_back({"grid",
                   "a rectangle in the x-y plane: {size: [width, height], vertices: [columns, "
                   "rows]}",
                   {},
                   {},
                   {"cloth"},
                   nullptr});
  kinds.push_back({"mesh",
                   "path of a triangle mesh: OBJ, STL, PLY, glTF or COLLADA",
                   {},
                   scale,
                   {"cloth"},
                   [](const std::string& path, const Parameters&, const Parameters& options) {
                     BodyGeometry geometry;
                     geometry.mesh = read_scaled_mesh(path, options);
                     validate(geometry.mesh, path);
                     return geometry;
                   }});
  kinds.push_back(
      {"mesh",
       "path of a closed triangle mesh: OBJ, STL, PLY, glTF or COLLADA",
       {},
       joined(joined(scale, interior_parameters()), {spacing_parameter()}),
       {"patch"},
       [](const std::string& path, const Parameters&, const Parameters& options) -> MadeGeometry {
         std::string note;
         const TriangleMesh mesh = read_body_surface(path, options, note, true);
         return with_place("mesh '" + path + "'", [&]() -> MadeGeometry {
           return {filled(mesh, options), note};
         });
       },
       least_filled});
  kinds.push_back(
      {"patches",
       "path of a body of free-form patches, as `pliant fit` writes them",
       {},
       joined(joined(scale, interior_parameters()), {level_parameter(), spacing_parameter()}),
       {"patch"},
       [](const std::string& path, const Parameters&, const Parameters& options) {
         return filled(scaled(read_patch_body(path), options.number("scale")), options);
       },
       least_filled});
  kinds.push_back(tetrahedral_mesh_kind());
  kinds.push_back(tube_kind());
  kinds.push_back(holed_sheet_kind());
  for (const auto& shape : patch_shape_registry().entries()) kinds.push_back(shape_kind(shape));
  kinds.push_back(block_kind());
  for (const auto& shape : patch_shape_registry().entries()) {
    kinds.push_back(particle_shape_kind(shape));
  }
  kinds.push_back(particle_block_kind());
  kinds.push_back(
      {"mesh",
       "path of a closed triangle mesh: OBJ, STL, PLY, glTF or COLLADA",
       {},
       joined(scale, particle_parameters()),
       {"viscoelastic"},
       [](const std::string& path, const Parameters&, const Parameters& options) -> MadeGeometry {
         std::string note;
         TriangleMesh mesh = read_body_surface(path, options, note);
         return {with_particles(std::move(mesh), options), note};
       },
       least_particles});
  kinds.push_back(reduced_model_kind());
  kinds.push_back(example_kind());
  add_rigid_kinds(kinds);
  return kinds;
}

}  // namespace

std::vector<ParameterSpec> GeometryKind::parameters() const { return joined(size, options); }

const std::vector<GeometryKind>& geometry_kinds() {
  static const std::vector<GeometryKind> kinds = make_kinds();
  return kinds;
}

std::vector<std::string> geometry_names(const std::string& model) {
  std::vector<std::string> names;
  for (const GeometryKind& kind : geometry_kinds()) {
    if (std::count(kind.models.begin(), kind.models.end(), model) > 0) names.push_back(kind.name);
  }
  return names;
}

const GeometryKind& find_geometry_kind(const std::string& name, const std::string& model) {
  for (const GeometryKind& kind : geometry_kinds()) {
    const bool suits = std::count(kind.models.begin(), kind.models.end(), model) > 0;
    if (kind.name == name && suits) return kind;
  }
  throw InputError(
      unknown_name_message("geometry of model '" + model + "'", name, geometry_names(model)));
}

}  // namespace pliant
