#include <gtest/gtest.h>

#include "pliant/models/reduced/reduced_file.h"
#include "unit/app/program.h"

namespace pliant {
namespace {

const std::string kOut = ::testing::TempDir() + "reduce_test.prm";

TEST(ReduceCommand, WritesAModelThatCanBeRead) {
  std::remove(kOut.c_str());
  const Outcome outcome = run("reduce beam --modes 3 --rank 5 --young 2e6 --out " + kOut);
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "3 modes -> rank 5")) << outcome.text;
  const ReducedModel model = read_reduced_model(kOut);
  EXPECT_EQ(model.name, "beam");
  EXPECT_EQ(model.rank(), 5);
  EXPECT_EQ(model.material.young, 2e6);
  std::remove(kOut.c_str());
}

TEST(ReduceCommand, RefusesBadArgumentsWithCode2) {
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

TEST(ReduceCommand, ReplacesNothingUnasked) {
  ASSERT_EQ(run_command("echo precious > " + kOut).code, 0);
  const Outcome refused = run("reduce beam --modes 3 --rank 5 --out " + kOut);
  EXPECT_EQ(refused.code, 2) << refused.text;
  EXPECT_EQ(contents(kOut), "precious\n");
  EXPECT_EQ(run("reduce beam --modes 3 --rank 5 --overwrite --out " + kOut).code, 0);
  EXPECT_EQ(contents(kOut).substr(0, 8), "PLIANTRM");
  std::remove(kOut.c_str());
}

}  // namespace
}  // namespace pliant
