#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/geometry/mesh/display_surface.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

class ReduceCommand : public testing::Test {
 protected:
  SceneFiles files_;
  const std::string out_ = files_.path("body.prm");
};

using StudyReducedCommand = ReduceCommand;

TEST_F(ReduceCommand, WritesAModelThatCanBeRead) {
  const Outcome outcome = run("reduce beam --modes 3 --rank 5 --young 2e6 --out " + out_);
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "3 modes -> rank 5")) << outcome.text;
  const ReducedModel model = read_reduced_model(out_);
  EXPECT_EQ(model.name, "beam");
  EXPECT_EQ(model.rank(), 5);
  EXPECT_EQ(model.material.young, 2e6);
}

TEST_F(ReduceCommand, RefusesBadArgumentsWithCode2) {
  for (const auto& [arguments, part] :
       {std::pair("reduce", "body"),
        {"reduce beam", "--out"},
        {"reduce tover --out /tmp/x.prm", "did you mean 'tower'?"},
        {"reduce beam --rank 9 --modes 2 --out /tmp/x.prm", "1 to 5"},
        {"reduce beam --mass round --out /tmp/x.prm", "consistent"},
        {"reduce beam --poisson 0.5 --out /tmp/x.prm", "poisson"},
        {"reduce beam --modes 3 --rank 4 --out /none/x.prm", "cannot write '/none/x.prm'"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.text;
    EXPECT_TRUE(holds(outcome.text, part)) << arguments << outcome.text;
  }
}

/// A block as a volumetric mesh of the Vega FEM library, of a material of its own.
std::string veg_of(const TetrahedralMesh& mesh) {
  std::string text = fmt::format("*VERTICES\n{} 3 0 0\n", mesh.vertices.cols());
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Eigen::Vector3d x = mesh.vertices.col(v);
    text += fmt::format("{} {} {} {}\n", v + 1, x[0], x[1], x[2]);
  }
  text += fmt::format("*ELEMENTS\nTET\n{} 4 0\n", mesh.tetrahedra.cols());
  for (Eigen::Index t = 0; t < mesh.tetrahedra.cols(); ++t) {
    const Eigen::Vector4i c = mesh.tetrahedra.col(t).array() + 1;
    text += fmt::format("{} {} {} {} {}\n", t + 1, c[0], c[1], c[2], c[3]);
  }
  return text + "*MATERIAL rubber\nENU, 1100, 3e6, 0.4\n*REGION\nallElements, rubber\n";
}

TEST_F(ReduceCommand, TakesTheMaterialOfAFileUnlessToldAnother) {
  const std::string mesh =
      files_.write("body.veg", veg_of(make_block({{1.0, 0.2, 0.2}, {6, 2, 2}})));
  const std::string common = "reduce " + mesh + " --modes 3 --rank 5 --overwrite --out " + out_;
  ASSERT_EQ(run(common + " --fix -1 -1 -1 -0.49 1 1").code, 0);
  const ReducedModel model = read_reduced_model(out_);
  EXPECT_EQ(model.material.density, 1100.0);
  EXPECT_EQ(model.material.young, 3e6);
  EXPECT_EQ(model.material.poisson, 0.4);
  EXPECT_EQ(std::count(model.fixed.begin(), model.fixed.end(), true), 9);
  ASSERT_EQ(run(common + " --young 2e6").code, 0);
  EXPECT_EQ(read_reduced_model(out_).material.young, 2e6);
  EXPECT_EQ(read_reduced_model(out_).material.density, 1100.0);
  files_.write("body.veg", "*VERTICES\n");
  const Outcome refused = run(common);
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(holds(refused.text, "body.veg")) << refused.text;
}

TEST_F(ReduceCommand, TakesAFileOfTetrahedra) {
  const std::string mesh = files_.path("reduce_test.msh");
  write_msh(mesh, make_block({{1.0, 0.2, 0.2}, {6, 2, 2}}));
  const std::string common = "reduce " + mesh + " --modes 3 --rank 5 --overwrite --out " + out_;
  ASSERT_EQ(run(common + " --fix -1 -1 -1 -0.49 1 1").code, 0);
  const ReducedModel model = read_reduced_model(out_);
  EXPECT_EQ(model.name, "reduce_test");
  EXPECT_EQ(std::count(model.fixed.begin(), model.fixed.end(), true), 9);
  ASSERT_EQ(run(common).code, 0);  // a free body
  const ReducedModel free = read_reduced_model(out_);
  EXPECT_EQ(std::count(free.fixed.begin(), free.fixed.end(), true), 0);
  const Outcome nowhere = run(common + " --fix 5 5 5 6 6 6");
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_TRUE(holds(nowhere.text, "--fix")) << nowhere.text;
  EXPECT_EQ(run("reduce /none/body.msh --out " + out_).code, 2);
}

TEST_F(ReduceCommand, FillsAClosedSurface) {
  const std::string surface = files_.path("box.obj");
  write_obj(surface, box_surface({0.5, 0.15, 0.15}));
  const std::string common = "reduce " + surface + " --modes 3 --rank 5 --overwrite --out " + out_;
  const Outcome outcome = run(common + " --tetrahedra 600 --fix -1 -1 -1 -0.49 1 1");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const ReducedModel model = read_reduced_model(out_);
  EXPECT_NEAR(static_cast<double>(model.mesh.tetrahedra.cols()), 600.0, 150.0);
  EXPECT_NEAR(model.mesh.vertices.row(0).maxCoeff(), 0.5, 0.02);
  // What is drawn and touched is the surface itself, to its edges.
  EXPECT_EQ(model.surface.triangles.cols(), box_surface({0.5, 0.15, 0.15}).triangles.cols());
  EXPECT_NEAR(model.surface.vertices.row(0).maxCoeff(), 0.5, 1e-7);
  EXPECT_EQ(run(common + " --tetrahedra 0").code, 2);
  const Outcome refused = run("reduce beam --tetrahedra 600 --overwrite --out " + out_);
  EXPECT_EQ(refused.code, 2);
  EXPECT_TRUE(holds(refused.text, "--tetrahedra")) << refused.text;
}

TEST_F(ReduceCommand, LeavesOutWhatAnUnfinishedRunWithOtherOptionsLeft) {
  const std::string finished = files_.path("finished.prm");
  const std::string options = "reduce beam --modes 3 --rank 5 --out ";
  ASSERT_EQ(run(options + finished).code, 0);
  EXPECT_FALSE(std::filesystem::exists(finished + ".unfinished"));
  const std::string parts = out_ + ".unfinished/parts";
  ASSERT_EQ(run_command("mkdir -p " + parts + " && echo other > " + parts + "/settings").code, 0);
  ASSERT_EQ(run_command("echo bad > " + parts + "/modes").code, 0);
  const Outcome afresh = run(options + out_);
  ASSERT_EQ(afresh.code, 0) << afresh.text;
  EXPECT_TRUE(holds(afresh.text, "afresh")) << afresh.text;
  EXPECT_EQ(contents(out_), contents(finished));
  EXPECT_FALSE(std::filesystem::exists(out_ + ".unfinished"));
}

TEST_F(ReduceCommand, ReplacesNothingUnasked) {
  ASSERT_EQ(run_command("echo precious > " + out_).code, 0);
  const Outcome refused = run("reduce beam --modes 3 --rank 5 --out " + out_);
  EXPECT_EQ(refused.code, 2) << refused.text;
  EXPECT_EQ(contents(out_), "precious\n");
  EXPECT_EQ(run("reduce beam --modes 3 --rank 5 --overwrite --out " + out_).code, 0);
  EXPECT_EQ(contents(out_).substr(0, 8), "PLIANTRM");
}

TEST_F(StudyReducedCommand, WritesItsTables) {
  const std::string folder = files_.path("study");
  const std::string common = "study reduced --no-plot --displacement 0.01 --out " + folder;
  ASSERT_EQ(run(common + " --experiment 1 --bodies beam --duration 1").code, 0);
  const std::string runs = contents(folder + "/runs_0.csv");
  // Three loads, three scales, five integrators, and the head.
  EXPECT_EQ(std::count(runs.begin(), runs.end(), '\n'), 46);
  EXPECT_TRUE(holds(runs, "beam,impulse,0,1,trigonometric,"));
  EXPECT_TRUE(holds(contents(folder + "/energy_beam_sine_undamped.csv"), "newmark_1,"));
  ASSERT_EQ(run(common + " --experiment thesis --bodies beam --duration 1").code, 0);
  EXPECT_TRUE(holds(contents(folder + "/thesis.csv"), "beam,soft,impulse,0,1,9,6,"));
  ASSERT_EQ(run(common + " --experiment 3 --steps 2000").code, 0);
  EXPECT_TRUE(holds(contents(folder + "/long.csv"), "trigonometric,2000,"));
  EXPECT_TRUE(holds(contents(folder + "/long_energy.csv"), "newmark,"));
}

TEST_F(StudyReducedCommand, MakesFinishedPartsOnlyOnce) {
  const std::string folder = files_.path("study");
  const std::string common =
      "study reduced --no-plot --displacement 0.01 --experiment 3 --out " + folder;
  ASSERT_EQ(run(common + " --steps 2000").code, 0);
  const std::string part = folder + "/parts/long_trigonometric";
  ASSERT_EQ(run_command("echo kept,2000 > " + part).code, 0);
  ASSERT_EQ(run(common + " --steps 2000").code, 0);
  EXPECT_TRUE(holds(contents(folder + "/long.csv"), "kept,2000"));
  const Outcome other = run(common + " --steps 3000");
  ASSERT_EQ(other.code, 0);
  EXPECT_TRUE(holds(other.text, "afresh")) << other.text;
  EXPECT_TRUE(holds(contents(folder + "/long.csv"), "trigonometric,3000,"));
}

TEST_F(StudyReducedCommand, RefusesBadArgumentsWithCode2) {
  for (const auto& [arguments, part] :
       {std::pair("", "--out"),
        {"--out /tmp/x --experiment 5", "precision"},
        {"--out /tmp/x --experiment sped", "did you mean 'speed'?"},
        {"--out /tmp/x --bodies beem", "did you mean 'beam'?"},
        {"--out /tmp/x --displacement 0", "--displacement"},
        {"--out /tmp/x --duration nan", "--duration"},
        {"--out /tmp/x --steps 5", "--steps"},
        {"--out /proc/none/x --experiment floor", "/proc/none/x"}}) {
    const Outcome outcome = run(std::string("study reduced ") + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.text;
    EXPECT_TRUE(holds(outcome.text, part)) << arguments << outcome.text;
  }
}

}  // namespace
}  // namespace pliant
