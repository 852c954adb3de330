#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/models/reduced/integrators/imex_thesis.h"
#include "pliant/models/reduced/integrators/stoermer_verlet.h"
#include "pliant/models/reduced/reduced_model.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant {
namespace {

std::unique_ptr<Solver> make(const std::string& name, const ParameterText& text = {}) {
  const SolverRegistry::Entry& entry = integrator_registry().find_for(name, "reduced");
  return entry.make(parse_parameters(entry.parameters, text, name));
}

/// V = ½ ω² q² + ¼ c q⁴ of one coordinate.
ReducedSystem oscillator(double omega, double c = 0.0) {
  return ReducedSystem(
      QuarticPotential(Eigen::VectorXd::Constant(1, omega * omega), {0.0, 0.25 * c}, "oscillator"));
}

/// A cantilever of a few coordinates; about 6 to 60 Hz.
const ReducedModel& cantilever_model() {
  static const ReducedModel model =
      *reduce(cantilever({{1.0, 0.1, 0.12}, {8, 1, 2}}, {1e7, 0.3, 1000.0}), {4, 8}, "beam", go_on);
  return model;
}

ReducedSystem swinging_cantilever() {
  ReducedSystem system(cantilever_model().potential);
  system.q = random_vector(8, 0.02, 1);
  system.p = random_vector(8, 0.5, 2);
  return system;
}

StepReport run(Solver& solver, ReducedSystem& system, double h, int steps) {
  StepReport report;
  solver.prepare(system, h);
  for (int k = 0; k < steps; ++k) solver.step(system, h, report);
  return report;
}

double energy(const ReducedSystem& system) {
  return system.elastic_energy() + system.kinetic_energy();
}

enum class Turn { kExplicit, kImplicit, kExact };

struct Method {
  std::string name;
  ParameterText parameters;
  Turn turn;
  double cosine(double x) const {
    if (turn == Turn::kExact) return std::cos(x);
    if (turn == Turn::kExplicit) return 1.0 - 0.5 * x * x;
    return (1.0 - 0.25 * x * x) / (1.0 + 0.25 * x * x);
  }
};

std::vector<Method> methods() {
  return {{"stoermer_verlet", {}, Turn::kExplicit},
          {"trigonometric", {}, Turn::kExact},
          {"imex_thesis", {}, Turn::kExplicit},
          {"imex_thesis", {{"split", "1e-6"}, {"tolerance", "1e-13"}}, Turn::kImplicit},
          {"newmark", {{"tolerance", "1e-13"}}, Turn::kImplicit},
          {"newmark", {{"iterations", "1"}, {"tolerance", "0"}}, Turn::kImplicit},
          {"midpoint", {{"tolerance", "1e-13"}}, Turn::kImplicit}};
}

TEST(Integrators, AnOscillatorTurnsByTheAngleOfTheory) {
  // qₖ₊₁ + qₖ₋₁ = 2 cos θ qₖ: cos θ = 1 - x²/2 explicit, (1 - x²/4)/(1 + x²/4) implicit, x = h ω;
  // θ = x exactly.
  const double omega = 40.0;
  for (const Method& method : methods()) {
    for (const double x : {0.1, 0.5, 1.0}) {
      ReducedSystem system = oscillator(omega);
      system.q[0] = 0.3;
      system.p[0] = 0.7 * omega;
      const auto solver = make(method.name, method.parameters);
      solver->prepare(system, x / omega);
      StepReport report;
      double before = system.q[0], now = before;
      for (int k = 0; k < 50; ++k) {
        solver->step(system, x / omega, report);
        if (k > 0) {
          EXPECT_NEAR(system.q[0] + before, 2.0 * method.cosine(x) * now, 1e-12);
          before = now;
        }
        now = system.q[0];
      }
      EXPECT_TRUE(report.warnings.empty()) << method.name;
    }
  }
}

TEST(Integrators, AnOscillatorKeepsTheAmplitudeOfTheory) {
  // p² + ω² q² (1 - x²/4) is constant for explicit ones, p² + ω² q² for others.
  const double omega = 40.0;
  for (const Method& method : methods()) {
    if (method.name == "imex_thesis" && method.turn == Turn::kExplicit)
      continue;  // p is half a step apart
    for (const double x : {0.1, 0.5, 1.0}) {
      ReducedSystem system = oscillator(omega);
      system.q[0] = 0.3;
      const auto invariant = [&] {
        const double share = method.turn == Turn::kExplicit ? 1.0 - 0.25 * x * x : 1.0;
        return system.p.squaredNorm() + omega * omega * share * system.q.squaredNorm();
      };
      const double start = invariant();
      const auto solver = make(method.name, method.parameters);
      run(*solver, system, x / omega, 10000);
      EXPECT_NEAR(invariant(), start, 1e-10 * start) << method.name << " x " << x;
    }
  }
}

TEST(Integrators, ADampedOscillatorDiesAtTheRateOfTheory) {
  for (const Method& method : methods()) {
    ReducedSystem system = oscillator(40.0);
    system.damping = {0.6, 1e-3};  // D = 0.6 + 1e-3 · 1600 = 2.2
    system.q[0] = 1.0;
    const auto solver = make(method.name, method.parameters);
    const double h = 1e-4;
    run(*solver, system, h, 10000);
    // The envelope falls as exp(-D t/2) but for the error of the step, h ω squared at most.
    const double envelope = std::exp(-1.1);
    const double size = std::sqrt(2.0 * energy(system)) / 40.0;
    EXPECT_NEAR(size / envelope, 1.0, 2.0 * 2.2 / (2.0 * 40.0)) << method.name;
  }
}

double error_at(const Method& method, double h, double duration) {
  const auto end = [&](Solver& solver, double step) {
    ReducedSystem system = swinging_cantilever();
    system.damping = {0.3, 1e-4};
    system.force = random_vector(8, 2.0, 3);
    run(solver, system, step, static_cast<int>(std::lround(duration / step)));
    Eigen::VectorXd state(16);
    state << system.q, system.p / 100.0;
    return state;
  };
  static const Eigen::VectorXd exact = [&] {
    const auto reference = make("reference", {{"substeps", "1"}});
    return end(*reference, duration / 8192);
  }();
  const auto solver = make(method.name, method.parameters);
  return (end(*solver, h) - exact).norm();
}

TEST(Integrators, AreOfSecondOrder) {
  std::vector<Method> all = methods();
  const double duration = 0.0512;
  for (const Method& method : all) {
    if (method.name == "imex_thesis") continue;  // its momenta are half a step apart: first order
    const double coarse = error_at(method, duration / 512, duration);
    const double fine = error_at(method, duration / 1024, duration);
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.05) << method.name << " " << coarse;
  }
  const Method reference{"reference", {{"substeps", "1"}}, Turn::kImplicit};
  const double coarse = error_at(reference, duration / 512, duration);
  EXPECT_NEAR(std::log2(coarse / error_at(reference, duration / 1024, duration)), 4.0, 0.1);
}

TEST(ImexThesis, IsOfFirstOrderWhereItIsExplicit) {
  // Momenta are half a step apart there; where all is implicit it is the midpoint rule.
  const double duration = 0.0512;
  for (const Method& method : methods()) {
    if (method.name != "imex_thesis") continue;
    const double coarse = error_at(method, duration / 1024, duration);
    const double order = std::log2(coarse / error_at(method, duration / 2048, duration));
    EXPECT_NEAR(order, method.turn == Turn::kExplicit ? 1.0 : 2.0, 0.05);
  }
}

TEST(Integrators, RunBackToTheirStart) {
  for (const Method& method : methods()) {
    if (method.name == "imex_thesis") continue;
    if (method.parameters.count("iterations") > 0) continue;  // linearised at one end of the step
    ReducedSystem system = swinging_cantilever();
    const Eigen::VectorXd q = system.q, p = system.p;
    const auto solver = make(method.name, method.parameters);
    run(*solver, system, 1e-4, 200);
    EXPECT_GT((system.q - q).norm(), 0.01 * q.norm());
    system.p *= -1.0;
    run(*solver, system, 1e-4, 200);
    EXPECT_LT((system.q - q).norm(), 1e-9 * q.norm()) << method.name;
    EXPECT_LT((system.p + p).norm(), 1e-9 * p.norm()) << method.name;
  }
}

double cosine_of(const std::vector<double>& series) {
  // Least squares of qₖ₊₁ + qₖ₋₁ = 2 cos θ qₖ.
  double with = 0.0, own = 0.0;
  for (std::size_t k = 1; k + 1 < series.size(); ++k) {
    with += 0.5 * (series[k + 1] + series[k - 1]) * series[k];
    own += series[k] * series[k];
  }
  return with / own;
}

TEST(Trigonometric, ACoordinateRingsAtItsOwnFrequencyUpToHalfATurn) {
  // Up to h ω = 0.95 π exactly, up to π within 5 %; in any number of substeps.
  const double h = 0.003;
  const auto solver = make("trigonometric");
  for (const double x : {0.1, 1.0, 2.0, 2.9, 3.1}) {
    ReducedSystem system = oscillator(x / h);
    system.p[0] = 1.0;
    solver->prepare(system, h);
    std::vector<double> series;
    StepReport report;
    double largest = 0.0;
    for (int k = 0; k < 300; ++k) {
      solver->step(system, h, report);
      series.push_back(system.q[0]);
      largest = std::max(largest, std::abs(system.q[0]));
      ASSERT_NEAR(energy(system), 0.5, 1e-9) << x;
    }
    EXPECT_NEAR(std::acos(cosine_of(series)), x, x < 0.95 * M_PI ? 1e-9 : 0.05 * x) << x;
    EXPECT_LE(largest, 1.0001 * h / x);
    EXPECT_TRUE(report.warnings.empty());
  }
}

TEST(Trigonometric, DampingTakesWhatItShouldInAStep) {
  for (const double x : {0.3, 2.5, 30.0}) {
    ReducedSystem system = oscillator(x / 0.003);
    system.damping = {20.0, 0.0};
    system.p[0] = 1.0;
    run(*make("trigonometric"), system, 0.003, 400);
    // The amplitude falls as exp(-D t/2); the energy swings by D/ω of itself as it does.
    EXPECT_NEAR(energy(system) / (0.5 * std::exp(-20.0 * 0.003 * 400)), 1.0, 0.21) << x;
  }
}

TEST(Trigonometric, RestsWhereForcesAreBalanced) {
  // Strongly bent, at a step that cannot show the fastest coordinates.
  ReducedSystem system(cantilever_model().potential, {30.0, 0.0});
  system.force = random_vector(8, 100.0, 3);
  run(*make("trigonometric"), system, 2e-2, 3000);
  QuarticPotential::Workspace space;
  Eigen::VectorXd r;
  system.potential.evaluate(system.q, r, space);
  EXPECT_LT((r - system.force).norm(), 1e-9 * system.force.norm());
  EXPECT_GT((r - system.potential.lambda().cwiseProduct(system.q)).norm(), 0.01 * r.norm());
}

TEST(Trigonometric, FollowsABodyThatStiffensBeyondTheExplicitLimit) {
  // h ω = 1.4 at rest; at the amplitude of the start the tangent's is 4.6.
  const double omega = 1.4 / 0.003;
  const ReducedSystem start = [&] {
    ReducedSystem system = oscillator(omega, 3.3 * omega * omega);
    system.q[0] = 1.0;
    return system;
  }();
  ReducedSystem verlet = start;
  run(*make("stoermer_verlet"), verlet, 0.003, 100);
  EXPECT_FALSE(energy(verlet) < 1e6 * energy(start));
  ReducedSystem system = start;
  const auto solver = make("trigonometric");
  solver->prepare(system, 0.003);
  double highest = 0.0, lowest = energy(start);
  int divided = 0;
  for (int k = 0; k < 100000; ++k) {
    StepReport report;
    solver->step(system, 0.003, report);
    divided += static_cast<int>(report.iterations > 1);
    highest = std::max(highest, energy(system));
    lowest = std::min(lowest, energy(system));
  }
  EXPECT_GE(divided, 1000);
  EXPECT_LT(highest, 1.05 * energy(start));
  EXPECT_GT(lowest, 0.95 * energy(start));
}

TEST(Trigonometric, KeepsTheBalanceOfEnergyWhereTheStepIsTooLongForTheMotion) {
  // h ω is 0.2 to 1.9 at rest; with so strong a pull the tangent's is several times as large.
  ReducedSystem system(cantilever_model().potential);
  const Eigen::VectorXd pull = random_vector(8, 2000.0, 5);
  const auto solver = make("trigonometric");
  const double h = 5e-3;
  solver->prepare(system, h);
  double work = 0.0, divided = 0.0, mean = 0.0;
  constexpr int kSteps = 20000, kPull = 200;
  for (int k = 0; k < kSteps; ++k) {
    StepReport report;
    system.force = (k < kPull ? 1.0 : 0.0) * pull;
    const Eigen::VectorXd q = system.q;
    solver->step(system, h, report);
    work += system.force.dot(system.q - q);
    divided += report.iterations > 1 ? 1.0 : 0.0;
    if (k >= kSteps / 2) mean += energy(system) / (kSteps / 2);
  }
  EXPECT_GT(divided, 100.0);
  EXPECT_NEAR(mean, work, 0.03 * work);
}

TEST(Trigonometric, GoesOnFromACheckpointBitForBit) {
  ReducedSystem system = swinging_cantilever();
  system.q *= 8.0;
  const auto solver = make("trigonometric");
  EXPECT_GT(run(*solver, system, 5e-3, 20).iterations, 1);
  StateArchive numbers;
  solver->save(numbers);
  ReducedSystem copy = system;
  const auto other = make("trigonometric");
  other->prepare(copy, 5e-3);
  numbers.rewind();
  other->load(numbers);
  StepReport report;
  for (int k = 0; k < 1000; ++k) {
    solver->step(system, 5e-3, report);
    other->step(copy, 5e-3, report);
    ASSERT_EQ(system.q, copy.q);
    ASSERT_EQ(system.p, copy.p);
  }
}

TEST(Integrators, ASwapInMotionKeepsTheStateAndNothingElse) {
  // After steps of another integrator, or its own elsewhere, each goes on as a new one would.
  for (const std::string& name : integrator_registry().names()) {
    const auto used = make(name), fresh = make(name);
    ReducedSystem elsewhere = swinging_cantilever();
    elsewhere.q *= 0.1;
    run(*used, elsewhere, 5e-4, 3);
    ReducedSystem a = swinging_cantilever();
    run(*make("midpoint"), a, 5e-4, 3);
    ReducedSystem b = a;
    run(*used, a, 5e-4, 5);
    run(*fresh, b, 5e-4, 5);
    EXPECT_EQ(a.q, b.q) << name;
    EXPECT_EQ(a.p, b.p) << name;
  }
}

TEST(Integrators, ABodyUnderCompressionStaysBoundedAndIsFoundOut) {
  // The energy is never negative and grows with q⁴, so that a force cannot run away with it.
  const ReducedModel& model = cantilever_model();
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, model.mesh.vertices.cols());
  for (Eigen::Index v = 0; v < forces.cols(); ++v) {
    if (model.mesh.vertices(0, v) > 0.49) forces(0, v) = -1e4;
  }
  EXPECT_NEAR(model.smallest_stretch(Eigen::VectorXd::Zero(8)), 1.0, 1e-12);
  for (const char* name : {"trigonometric", "midpoint", "newmark"}) {
    ReducedSystem system(model.potential, {5.0, 0.0});
    system.force = model.reduced_force(forces);
    const auto solver = make(name);
    solver->prepare(system, 1e-3);
    double largest = 0.0;
    StepReport report;
    for (int k = 0; k < 5000; ++k) {
      solver->step(system, 1e-3, report);
      largest = std::max(largest, system.q.norm());
    }
    // V(q) <= f·q with V >= c |q|⁴ beyond what bends: a few body lengths' worth.
    EXPECT_LT(model.positions(system.q).cwiseAbs().maxCoeff(), 5.0) << name;
    EXPECT_TRUE(std::isfinite(largest)) << name;
    EXPECT_LT(model.smallest_stretch(system.q), kSofteningStretch) << name;
  }
}

TEST(ImexThesis, SplitsAtTheSamplingFrequency) {
  ReducedSystem system(cantilever_model().potential);
  const Eigen::VectorXd f = system.potential.lambda().cwiseSqrt() / (2.0 * M_PI);
  ImexThesis thesis(1.0, {});
  for (const int low : {0, 3, 8}) {
    const double at = low == 0 ? 0.5 * f[0] : low == 8 ? 2.0 * f[7] : 0.5 * (f[low - 1] + f[low]);
    thesis.prepare(system, 1.0 / at);
    EXPECT_EQ(thesis.explicit_count(), low);
  }
}

TEST(Integrators, RefuseParametersOutOfRange) {
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, ParameterText>>{{"trigonometric", {{"exact", "3.2"}}},
                                                          {"trigonometric", {{"slowed", "1.6"}}},
                                                          {"trigonometric", {{"limit", "1.1"}}},
                                                          {"trigonometric", {{"drift", "0"}}},
                                                          {"imex_thesis", {{"split", "0"}}},
                                                          {"newmark", {{"iterations", "0"}}},
                                                          {"midpoint", {{"tolerance", "-1"}}},
                                                          {"midpoint", {{"tolerance", "nan"}}},
                                                          {"reference", {{"substeps", "0"}}},
                                                          {"stoermer_verlet", {{"split", "1"}}}}) {
    EXPECT_THROW(make(name, text), InputError) << name;
  }
  EXPECT_THROW(make("imx"), InputError);
}

}  // namespace
}  // namespace pliant
