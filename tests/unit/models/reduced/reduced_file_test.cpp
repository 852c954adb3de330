#include "pliant/models/reduced/files/reduced_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "pliant/models/reduced/files/example_bodies.h"
#include "unit/geometry/expect_refusal.h"
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

TEST_F(ReducedFileTest, RefusesEveryTruncation) {
  for (std::size_t size = 0; size < bytes_.size(); size += 7) {
    expect_refused(bytes_.substr(0, size), {path_});
    // Also where the header says that this is all.
    if (size >= 32) expect_refused(signed_again(bytes_.substr(0, size)), {path_});
  }
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
  other[8] = 2;
  expect_refused(other, {"version 2, but 1 is read", "pliant reduce"});
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
  other.replace(bytes_.size() - 8, 8, reinterpret_cast<const char*>(&nan), 8);
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
