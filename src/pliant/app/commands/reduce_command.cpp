#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/elements/solids/averaged_tetrahedra.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "pliant/geometry/repair/body_surface.h"
#include "pliant/math/error.h"
#include "pliant/models/reduced/files/cub_model.h"
#include "pliant/models/reduced/files/example_bodies.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/study/experiments/reduced_parts.h"

namespace pliant {
namespace {

struct ReduceCommand {
  std::string body;
  std::string out;
  std::string mass = "consistent";
  std::string strain = "tetrahedra";
  std::string cub, basis;  // files of another library; both or none
  std::optional<int> modes, rank;
  std::optional<double> young, poisson, density;
  std::optional<int> tetrahedra;  // of a surface
  std::vector<double> fix;        // lowest and highest corner of a box [m]
  bool overwrite = false;
  bool progress = false;
};

/// The vertices within a box of two corners. Throws InputError when there is none.
std::vector<int> vertices_in_box(const TetrahedralMesh& mesh, const std::vector<double>& corners) {
  const Eigen::Map<const Eigen::Array3d> low(corners.data()), high(corners.data() + 3);
  std::vector<int> found;
  for (int v = 0; v < static_cast<int>(mesh.vertices.cols()); ++v) {
    const Eigen::Array3d x = mesh.vertices.col(v);
    if ((x >= low).all() && (x <= high).all()) found.push_back(v);
  }
  if (found.empty()) throw InputError("--fix: no vertex of the body lies in this box");
  return found;
}

/// Takes the tetrahedra of a file, with its material, or those that fill the closed surface of one.
void load_mesh(const ReduceCommand& options, ExampleBody& body) {
  std::string extension = std::filesystem::path(options.body).extension().string();
  for (char& letter : extension) letter = static_cast<char>(std::tolower(letter));
  const std::vector<std::string> surfaces = {".obj", ".stl", ".ply", ".gltf", ".glb", ".dae"};
  const bool is_surface = std::count(surfaces.begin(), surfaces.end(), extension) > 0;
  if (!is_surface) {
    if (options.tetrahedra) {
      throw InputError("--tetrahedra: is for a closed surface; this body has its own");
    }
    MeshWithMaterial file = read_tetrahedral_file(options.body);
    body.mesh = std::move(file.mesh);
    if (file.material) {
      body.material = {file.material->young, file.material->poisson, file.material->density};
    }
    return;
  }
  StuffingOptions stuffing;
  stuffing.tetrahedra = options.tetrahedra.value_or(stuffing.tetrahedra);
  const TriangleMesh mesh = read_triangle_mesh(options.body);
  std::string note;
  body.surface = with_place("mesh '" + options.body + "'",
                            [&] { return make_body_surface(mesh, note, true); });
  if (!note.empty()) std::cerr << "note: " << options.body << " was mended: " << note << std::endl;
  body.mesh = stuff(body.surface, stuffing, options.body);
}

/// An example, or the body of a file, free unless --fix says.
ExampleBody load_body(const ReduceCommand& options) {
  const std::filesystem::path path(options.body);
  ExampleBody body;
  if (path.has_extension() || path.has_parent_path()) {
    body.name = path.stem().string();
    load_mesh(options, body);
  } else {
    body = example_body(options.body);
    if (options.tetrahedra) {
      throw InputError("--tetrahedra: is for a closed surface; this body has its own");
    }
  }
  if (!options.fix.empty()) body.fixed = vertices_in_box(body.mesh, options.fix);
  return body;
}

void apply(const ReduceCommand& options, ExampleBody& body) {
  body.reduction.modes = options.modes.value_or(body.reduction.modes);
  body.reduction.rank = options.rank.value_or(body.reduction.rank);
  if (options.mass == "lumped") {
    body.reduction.mass = MassMatrix::kLumped;
  } else if (options.mass != "consistent") {
    throw InputError(unknown_name_message("mass", options.mass, {"consistent", "lumped"}));
  }
  if (options.strain != "tetrahedra" && options.strain != kAveragedStrain) {
    throw InputError(
        unknown_name_message("strain", options.strain, {"tetrahedra", kAveragedStrain}));
  }
  body.averaged = options.strain == kAveragedStrain;
  body.material.young = options.young.value_or(body.material.young);
  body.material.poisson = options.poisson.value_or(body.material.poisson);
  body.material.density = options.density.value_or(body.material.density);
}

void print_summary(const ReducedModel& model, const std::string& path, double seconds) {
  const Eigen::VectorXd& lambda = model.potential.lambda();
  fmt::print("{}: {} vertices, {} tetrahedra, {} modes -> rank {}, in {:.2f} s\n", model.name,
             model.mesh.vertices.cols(), model.mesh.tetrahedra.cols(), model.modes, model.rank(),
             seconds);
  fmt::print("frequencies at rest [Hz]:");
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    fmt::print(" {:.4g}", std::sqrt(lambda[i]) / (2.0 * M_PI));
  }
  fmt::print("\ncoefficients: {} of the energy, {} kB\nwritten: {}\n",
             QuarticPotential::coefficient_count(model.rank()), model.potential.bytes() / 1000,
             path);
  std::fflush(stdout);
}

template <class Numbers>
void hash(const Numbers& numbers, std::uint64_t& state) {  // FNV-1a
  const auto* bytes = reinterpret_cast<const unsigned char*>(numbers.data());
  const std::size_t size = static_cast<std::size_t>(numbers.size()) * sizeof(numbers.data()[0]);
  for (std::size_t k = 0; k < size; ++k) state = (state ^ bytes[k]) * 0x100000001b3u;
}

/// Everything that modes and derivatives depend on.
std::string settings_of(const ExampleBody& body) {
  std::uint64_t mesh = 0xcbf29ce484222325u;
  hash(body.mesh.vertices, mesh);
  hash(body.mesh.tetrahedra, mesh);
  hash(body.fixed, mesh);
  return fmt::format("version 1\nmesh {:016x}\nmaterial {} {} {}\nmodes {}\nmass {}\n{}", mesh,
                     body.material.young, body.material.poisson, body.material.density,
                     body.reduction.modes, static_cast<int>(body.reduction.mass),
                     body.averaged ? "strain averaged\n" : "");
}

std::string bytes_of(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return "";
  const std::int64_t rows = matrix.rows();
  std::string bytes(sizeof rows + static_cast<std::size_t>(matrix.size()) * sizeof(double), ' ');
  std::memcpy(bytes.data(), &rows, sizeof rows);
  std::memcpy(bytes.data() + sizeof rows, matrix.data(), bytes.size() - sizeof rows);
  return bytes;
}

Eigen::MatrixXd matrix_of(const std::string& bytes) {
  if (bytes.empty()) return {};
  std::int64_t rows;
  std::memcpy(&rows, bytes.data(), sizeof rows);
  const auto count = static_cast<Eigen::Index>((bytes.size() - sizeof rows) / sizeof(double));
  Eigen::MatrixXd matrix(rows, count / rows);
  std::memcpy(matrix.data(), bytes.data() + sizeof rows, bytes.size() - sizeof rows);
  return matrix;
}

/// Where a reduction that is not finished keeps what is: beside the file that it will write.
ReducedParts parts_of(const ReduceCommand& options, const ExampleBody& body) {
  const std::filesystem::path out(options.out);
  if (out.has_parent_path() && !std::filesystem::is_directory(out.parent_path())) {
    throw InputError(fmt::format("cannot write '{}': there is no folder '{}'", options.out,
                                 out.parent_path().string()));
  }
  return ReducedParts(options.out + ".unfinished", settings_of(body));
}

/// From files of the Vega FEM library instead of a reduction.
int convert_cub(const ReduceCommand& options, const ExampleBody& body) {
  if (options.cub.empty() || options.basis.empty()) {
    throw InputError("--cub and --basis go together: a polynomial and the basis that it is for");
  }
  if (options.modes || options.rank || !options.fix.empty() || options.mass != "consistent") {
    throw InputError(
        "--cub: --modes, --rank, --mass and --fix belong to a reduction; these files are one");
  }
  const Timer timer;
  ReducedModel model =
      make_cub_model(options.cub, options.basis, body.mesh, body.material, body.name);
  model.surface = body.surface;
  const double difference = force_difference(model);
  write_reduced_model(options.out, model);
  print_summary(model, options.out, timer.seconds());
  fmt::print("force: differs from this mesh and material's by {:.2g} of it\n", difference);
  std::fflush(stdout);
  return kOk;
}

int reduce_body(const ReduceCommand& options) {
  ExampleBody body = load_body(options);
  apply(options, body);
  if (!options.overwrite && std::filesystem::exists(options.out)) {
    throw InputError(fmt::format("'{}' exists: --overwrite replaces it", options.out));
  }
  if (!options.cub.empty() || !options.basis.empty()) return convert_cub(options, body);
  catch_interrupts();
  const Timer timer;
  ProgressBar bar(options.progress || isatty(STDERR_FILENO) != 0);
  const StvkBody full(body.mesh, body.material, body.fixed, body.name, body.averaged);
  const ReducedParts parts = parts_of(options, body);
  if (parts.started_afresh()) {
    std::cerr << options.out << ".unfinished: was made with other options: afresh\n";
  }
  const auto progress = [&](double done, double total, const std::string& what) {
    bar.update(done, total, what);
    return !interrupted();
  };
  const auto store = [&](const std::string& name, const std::function<Eigen::MatrixXd()>& make) {
    return matrix_of(parts.part(name, [&] { return bytes_of(make()); }));
  };
  std::optional<ReducedModel> model = reduce(full, body.reduction, body.name, progress, store);
  bar.clear();
  if (!model) {
    std::cerr << "interrupted: the same command goes on from " << options.out << ".unfinished\n";
    return kInterrupted;
  }
  model->surface = body.surface;
  write_reduced_model(options.out, *model);
  parts.remove();
  print_summary(*model, options.out, timer.seconds());
  return kOk;
}

std::string bodies_text() {
  std::string text = "Bodies:\n";
  for (const std::string& name : example_names()) {
    text += fmt::format("  {:<10} {}\n", name, example_description(name));
  }
  return text + "The file's layout is in docs/reduced.md.";
}

}  // namespace

void add_reduce_command(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "reduce", "Compute the reduced model of a body and write it to a file");
  command->footer(bodies_text() + "\n\n" + command->get_footer());
  auto options = std::make_shared<ReduceCommand>();
  command
      ->add_option("body", options->body,
                   "Which body, or a file of tetrahedra (Gmsh, TetGen, Vega) or of a closed "
                   "surface (OBJ, STL, "
                   "PLY, glTF, COLLADA)")
      ->required()
      ->type_name("BODY");
  command->add_option("--out", options->out, "The file to write")->required()->type_name("FILE");
  command->add_option("--modes", options->modes, "Linear modes k; the body's own unless this says")
      ->type_name("K");
  command
      ->add_option(
          "--rank", options->rank,
          "Reduced coordinates r, at most k + k (k + 1)/2; the body's own unless this says")
      ->type_name("R");
  command->add_option("--mass", options->mass, "Mass matrix: consistent or lumped [consistent]")
      ->type_name("KIND");
  command
      ->add_option("--strain", options->strain,
                   "tetrahedra, or averaged around edges and vertices, which does not lock near "
                   "Poisson's ratio 0.5 [tetrahedra]")
      ->type_name("KIND");
  command->add_option("--young", options->young, "Another Young's modulus [Pa]")->type_name("PA");
  command->add_option("--poisson", options->poisson, "Another Poisson's ratio")->type_name("N");
  command->add_option("--density", options->density, "Another density [kg/m^3]")->type_name("RHO");
  command
      ->add_option("--cub", options->cub,
                   "Take the forces from a cubic polynomial of the Vega FEM library")
      ->type_name("FILE");
  command
      ->add_option("--basis", options->basis,
                   "The mass-orthonormal basis of --cub over the body's vertices, that library's "
                   "matrix file")
      ->type_name("FILE");
  command
      ->add_option("--tetrahedra", options->tetrahedra,
                   "About how many fill a closed surface [10000]")
      ->type_name("N");
  command
      ->add_option("--fix", options->fix,
                   "Fix the vertices within a box, two corners, in place of the body's own [m]")
      ->expected(6)
      ->type_name("X Y Z X Y Z");
  command->add_flag("--overwrite", options->overwrite, "Replace FILE when it exists");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->callback([options, &exit_code] { exit_code = reduce_body(*options); });
}

}  // namespace pliant
