#include <gtest/gtest.h>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/scene/reading/patch_file.h"
#include "support/worlds/surfaces.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

class FitTest : public testing::Test {
 protected:
  FitTest() : mesh_(files_.path("ball.obj")), body_(files_.path("ball.yaml")) {
    write_obj(mesh_, icosphere(4));
  }
  std::string fit(const std::string& more) const {
    return "fit " + mesh_ + " --out " + body_ + " " + more;
  }
  SceneFiles files_;
  std::string mesh_, body_;
};

TEST_F(FitTest, WritesABodyAndSaysHowNearItIs) {
  const Outcome outcome = run(fit("--triangles 80 --scale 0.1"));
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part : {"5120 triangles", "80 patches", "64 times fewer triangles", "bytes",
                           "distance: max ", " m, RMS "}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << " is not in: " << outcome.text;
  }
  const PatchBody body = read_patch_body(body_);
  EXPECT_EQ(body.base.triangles.cols(), 80);
  EXPECT_NEAR(body.base.vertices.colwise().norm().maxCoeff(), 0.1, 1e-6);
}

TEST_F(FitTest, ReplacesAFileOnlyWhenTold) {
  files_.write("ball.yaml", "mine");
  const Outcome kept = run(fit(""));
  EXPECT_EQ(kept.code, 2);
  EXPECT_TRUE(holds(kept.text, "--overwrite")) << kept.text;
  EXPECT_EQ(contents(body_), "mine");
  EXPECT_EQ(run(fit("--triangles 20 --overwrite")).code, 0);
  EXPECT_NO_THROW(read_patch_body(body_));
}

TEST_F(FitTest, RefusesBadInputAndWritesNothing) {
  write_obj(files_.path("open.obj"), without_last(icosphere(2), 1));
  for (const std::string& arguments :
       {fit("--triangles 3"), fit("--triangles x"), fit("--scale 0"), fit("--scale nan"),
        "fit " + mesh_, "fit /none.obj --out " + body_,
        "fit " + files_.path("open.obj") + " --out " + body_}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << ": " << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(body_)) << arguments;
  }
  const Outcome open = run("fit " + files_.path("open.obj") + " --out " + body_);
  EXPECT_TRUE(holds(open.text, "the surface is open, it has 3 boundary edges")) << open.text;
}

}  // namespace
}  // namespace pliant
