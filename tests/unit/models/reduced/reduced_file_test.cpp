#include "pliant/models/reduced/files/reduced_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "pliant/models/reduced/files/example_bodies.h"
#include "support/expect_refusal.h"
#include "unit/models/reduced/stvk_examples.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

class ReducedFileTest : public ::testing::Test {
 protected:
  ReducedFileTest() : model_(*reduce(small_cantilever(), {3, 4}, "small", go_on)) {
    write_reduced_model(path_, model_);
    bytes_ = read(path_);
  }

  static std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Expects the file to be refused with these bytes.
  void expect_refused(const std::string& bytes, const std::vector<std::string>& parts) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    expect_refusal([&] { read_reduced_model(path_); }, parts);
  }
  /// The bytes with a checksum and size that fit them.
  static std::string signed_again(std::string bytes) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (std::size_t k = 32; k < bytes.size(); ++k) {
      hash = (hash ^ static_cast<unsigned char>(bytes[k])) * 0x100000001b3ull;
    }
    const std::uint64_t size = bytes.size() - 32;
    bytes.replace(16, 8, reinterpret_cast<const char*>(&size), 8);
    bytes.replace(24, 8, reinterpret_cast<const char*>(&hash), 8);
    return bytes;
  }

  SceneFiles files_;
  const std::string path_ = files_.path("body.prm");
  ReducedModel model_;
  std::string bytes_;
};

TEST_F(ReducedFileTest, GivesBackTheSameModel) {
  const ReducedModel read = read_reduced_model(path_);
  EXPECT_EQ(read.name, "small");
  EXPECT_EQ(read.modes, 3);
  EXPECT_EQ(read.material.young, model_.material.young);
  EXPECT_EQ(read.material.poisson, model_.material.poisson);
  EXPECT_EQ(read.material.density, model_.material.density);
  EXPECT_EQ(read.mesh.vertices, model_.mesh.vertices);
  EXPECT_EQ(read.mesh.tetrahedra, model_.mesh.tetrahedra);
  EXPECT_EQ(read.fixed, model_.fixed);
  EXPECT_EQ(read.basis, model_.basis);
  EXPECT_EQ(read.potential.lambda(), model_.potential.lambda());
  EXPECT_EQ(read.potential.coefficients(), model_.potential.coefficients());
}

TEST_F(ReducedFileTest, ReadsTheVersionThatHadNoSurface) {
  std::string old = bytes_.substr(0, bytes_.size() - 8);
  old[8] = 1;
  std::ofstream(path_, std::ios::binary) << signed_again(old);
  const ReducedModel read = read_reduced_model(path_);
  EXPECT_EQ(read.basis, model_.basis);
  EXPECT_EQ(read.surface.triangles.cols(), 0);
}

TEST_F(ReducedFileTest, KeepsTheSurfaceAndRefusesOneThatIsNone) {
  model_.surface = Box(Eigen::Vector3d(1.0, 2.0, 3.0)).surface();
  write_reduced_model(path_, model_);
  EXPECT_EQ(read_reduced_model(path_).surface.vertices, model_.surface.vertices);
  EXPECT_EQ(read_reduced_model(path_).surface.triangles, model_.surface.triangles);
  const std::string good = read(path_);
  for (std::size_t size = good.size() - 1; size > bytes_.size() - 8; size -= 3) {
    expect_refused(signed_again(good.substr(0, size)), {path_});
  }
  std::string other = good;
  const std::int32_t none = 1000;  // a vertex that is not there
  other.replace(good.size() - 4, 4, reinterpret_cast<const char*>(&none), 4);
  expect_refused(signed_again(other), {"surface", "outside [0, 7]"});
  const std::uint32_t huge = 0xffffffffu;
  other = good;
  other.replace(bytes_.size() - 8, 4, reinterpret_cast<const char*>(&huge), 4);
  expect_refused(signed_again(other), {"shorter than its contents"});
  other = good;
  other.replace(bytes_.size() - 4, 4, reinterpret_cast<const char*>(&huge), 4);
  expect_refused(signed_again(other), {"shorter than its contents"});
}

TEST_F(ReducedFileTest, RefusesEveryTruncation) {
  for (std::size_t size = 0; size < bytes_.size(); size += 7) {
    expect_refused(bytes_.substr(0, size), {path_});
    // Also where the header says that this is all.
    if (size >= 32) expect_refused(signed_again(bytes_.substr(0, size)), {path_});
  }
  const std::size_t whole = bytes_.size() - 32;  // without the header
  expect_refused(bytes_.substr(0, bytes_.size() - 10),
                 {fmt::format(": {} bytes of {} are there", whole - 10, whole)});
  expect_refused(bytes_ + "x", {"truncated or altered"});
  expect_refused(signed_again(bytes_ + "x"), {"longer than its contents"});
}

TEST_F(ReducedFileTest, RefusesEveryAlteredByte) {
  for (std::size_t at = 0; at < bytes_.size(); at += 5) {
    std::string altered = bytes_;
    altered[at] = static_cast<char>(altered[at] ^ 0x40);
    expect_refused(altered, {path_});
  }
}

TEST_F(ReducedFileTest, SaysWhatIsWrong) {
  expect_refused("solid cube\n and more bytes than a header has", {"does not begin with PLIANTRM"});
  std::string other = bytes_;
  other[8] = 3;
  expect_refused(other, {"version 3, but 1 to 2 are read", "pliant reduce"});
  other = bytes_;
  other[12] = 1;
  expect_refused(other, {"another byte order"});
  other = bytes_;
  other[bytes_.size() - 1] ^= 1;
  expect_refused(other, {"checksum"});
  expect_refusal([] { read_reduced_model("/none/model.prm"); },
                 {"/none/model.prm", "No such file"});
}

TEST_F(ReducedFileTest, RefusesNumbersThatMakeNoModel) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string other = bytes_;
  // Before the surface, which has no vertices and no triangles.
  other.replace(bytes_.size() - 16, 8, reinterpret_cast<const char*>(&nan), 8);
  expect_refused(signed_again(other), {"coefficient", "not finite"});
  // The name's length, and the rank.
  const std::uint32_t huge = 0xffffffffu;
  other = bytes_;
  other.replace(32, 4, reinterpret_cast<const char*>(&huge), 4);
  expect_refused(signed_again(other), {"too long a name"});
  const std::size_t rank = 32 + 4 + 5 + 24 + 12;
  other = bytes_;
  other.replace(rank, 4, reinterpret_cast<const char*>(&huge), 4);
  expect_refused(signed_again(other), {"rank", "from 1 to 100"});
  other = bytes_;
  other.replace(rank - 8, 4, reinterpret_cast<const char*>(&huge), 4);
  expect_refused(signed_again(other), {"shorter than its contents"});
}

TEST(ReducedModel, RefusesARankThatItsModesDoNotSpan) {
  const StvkBody body = small_cantilever();
  expect_refusal([&] { reduce(body, {2, 6}, "small", go_on); }, {"small", "rank is 6", "1 to 5"});
  expect_refusal([&] { reduce(body, {0, 1}, "small", go_on); }, {"rank"});
  expect_refusal([&] { reduce(body, {2, 0}, "small", go_on); }, {"small", "rank is 0", "1 to 5"});
}

TEST(ReducedModel, StopsWhenAsked) {
  int calls = 0;
  const auto stop = [&](double, double, const std::string&) { return ++calls < 3; };
  EXPECT_FALSE(reduce(small_cantilever(), {3, 4}, "small", stop).has_value());
  EXPECT_EQ(calls, 3);
}

TEST(ReducedModel, ConsistentAndLumpedMassAgreeAsTheMeshRefines) {
  const auto frequency = [](int cells, MassMatrix mass) {
    const StvkBody body =
        cantilever({{1.0, 0.25, 0.25}, {cells, cells / 4, cells / 4}}, {1e6, 0.3, 1000.0});
    return std::sqrt(reduce(body, {2, 2, mass}, "beam", go_on)->potential.lambda()[0]);
  };
  const auto gap = [&](int cells) {
    const double lumped = frequency(cells, MassMatrix::kLumped);
    return frequency(cells, MassMatrix::kConsistent) / lumped - 1.0;
  };
  EXPECT_GT(gap(8), 0.0);
  EXPECT_NEAR(gap(16) / gap(8), 0.25, 0.1);  // of second order in the size of the tetrahedra
}

TEST(ExampleBodies, SmoothOnesCarryTheSurfaceThatTheirTetrahedraFill) {
  const std::vector<std::string> of_thesis = thesis_body_names();
  int smooth = 0;
  for (const std::string& name : example_names()) {
    const ExampleBody example = example_body(name);
    const bool has_surface = example.surface.triangles.cols() > 0;
    EXPECT_EQ(has_surface, std::count(of_thesis.begin(), of_thesis.end(), name) == 0) << name;
    if (!has_surface) continue;
    ++smooth;
    validate(example.surface, name);
    EXPECT_TRUE(boundary_vertices(example.surface).empty()) << name << " is open";
    const double volume = signed_volume(example.surface);
    EXPECT_NEAR(volumes(example.mesh).sum() / volume, 1.0, 0.05) << name;
    // What is drawn is what moves: but for the tip of the heart and those of the horse's ears,
    // which are thinner than tetrahedra.
    const double share = name == "rubber_horse" ? 0.06 : name == "soft_heart" ? 0.04 : 0.02;
    const NearestTriangle to_tetrahedra({example.mesh.vertices, boundary_triangles(example.mesh)});
    const Eigen::Vector3d extent = example.surface.vertices.rowwise().maxCoeff() -
                                   example.surface.vertices.rowwise().minCoeff();
    double farthest = 0.0;
    for (const auto v : example.surface.vertices.colwise()) {
      farthest = std::max(farthest, to_tetrahedra(v).distance);
    }
    EXPECT_LT(farthest, share * extent.maxCoeff()) << name;
  }
  EXPECT_EQ(smooth, 4);
}

TEST(ExampleBodies, AreWholeAndLoadedWhereTheyAreFree) {
  for (const std::string& name : example_names()) {
    const ExampleBody example = example_body(name);
    EXPECT_EQ(example.name, name);
    const StvkBody body(example.mesh, example.material, example.fixed, name);
    EXPECT_GE(body.index(example.loaded), 0) << name;
    EXPECT_EQ(rigid_motions(body, body.lumped_mass()).cols(), 0) << name;
    // A part that hangs by nothing would have motions without energy.
    const auto modes = linear_modes(body, body.rest_stiffness(), body.lumped_mass(), 1);
    EXPECT_GT(modes.lambda[0], 1.0) << name;
  }
  expect_refusal([] { example_body("bem"); }, {"bem", "beam"});
}

}  // namespace
}  // namespace pliant
