#include "pliant/study/experiments/ringing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

StudyBody body_of_example(const std::string& name) {
  StudyBody body;
  body.example = example_body(name);
  const StvkBody full(body.example.mesh, body.example.material, body.example.fixed, name);
  body.model = *reduce(full, body.example.reduction, name,
                       [](double, double, const std::string&) { return true; });
  const Eigen::Matrix3Xd& x = body.model.mesh.vertices;
  body.size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff();
  return body;
}

Ringing ringing_of(const StudyBody& body, const std::string& integrator, int coordinate) {
  return ring(body, {{integrator, integrator, {}}, coordinate, 1e-4});
}

TEST(Ringing, BodiesRingAtTheirOwnFrequenciesWhereAStepTakesAThirdOfASwing) {
  struct Case {
    const char* body;
    std::vector<std::pair<int, double>> lines;  // coordinate, Hz
  };
  for (const Case& c : {Case{"beam", {{6, 53.5}, {7, 84.1}}},
                        Case{"quadruped", {{2, 58.3}, {4, 119.0}}}, Case{"tower", {{2, 98.2}}}}) {
    const StudyBody body = body_of_example(c.body);
    for (const auto& [coordinate, hertz] : c.lines) {
      const double exact = std::sqrt(body.model.potential.lambda()[coordinate]) / (2.0 * M_PI);
      ASSERT_NEAR(exact, hertz, 0.002 * hertz) << c.body;
      const Ringing trigonometric = ringing_of(body, "trigonometric", coordinate);
      EXPECT_NEAR(trigonometric.frequency, exact, 0.002 * exact) << c.body;
      const Ringing midpoint = ringing_of(body, "midpoint", coordinate);
      EXPECT_LT(midpoint.frequency, 0.94 * exact) << c.body;  // as its theory has it
      // (A blow's height is the speed over ω, exactly.)
      const double height =
          1e-4 * body.size /
          Eigen::Map<const Eigen::Matrix3Xd>(body.model.basis.col(coordinate).data(), 3,
                                             body.model.basis.rows() / 3)
              .colwise()
              .norm()
              .maxCoeff();
      EXPECT_NEAR(trigonometric.amplitude, height, 0.05 * height) << c.body;
    }
  }
}

TEST(Ringing, TellsWhatBlowsUp) {
  EXPECT_TRUE(ringing_of(body_of_example("beam"), "stoermer_verlet", 6).blew_up);
}

}  // namespace
}  // namespace pliant
