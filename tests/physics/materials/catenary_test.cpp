// A hanging chain: where every solver comes to rest against the statics of the discrete chain, and
// that against the catenary.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/effects/registry.h"
#include "support/solvers/solvers.h"
#include "support/solvers/system_model.h"

namespace pliant::catenary_test {
namespace {

constexpr double kLength = 1.0, kSpan = 0.8, kMass = 0.02, kGravity = 9.81;
// Force per strain [N]: with a pull of about 0.15 N the chain lengthens by 1e-3.
constexpr double kStiffness = 150.0;

/// Links of a chain of springs at rest, ends at equal heights, from its horizontal pull.
struct Statics {
  Positions x;
  Statics(int links, double pull) : x(Positions::Zero(3, links + 1)) {
    const double l = kLength / links, weight = kGravity * kMass / links;
    for (int k = 0; k < links; ++k) {
      const double vertical = weight * (k - 0.5 * (links - 1));
      const double tension = std::hypot(pull, vertical);
      const double stretched = l * (1.0 + tension / kStiffness);
      x.col(k + 1) = x.col(k) + stretched / tension * Eigen::Vector3d(pull, 0, vertical);
    }
  }
  double span() const { return x(0, x.cols() - 1); }
};

/// The chain at rest with its ends kSpan apart.
Positions statics(int links) {
  double lo = 1e-6, hi = 100.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (lo + hi);
    (Statics(links, middle).span() < kSpan ? lo : hi) = middle;
  }
  return Statics(links, lo).x;
}

/// Depth of the catenary of kLength and kSpan below its ends at distance `x` from the left one.
double catenary_depth(double x) {
  double lo = 1e-3, hi = 1e3;  // 2 a sinh(span / 2a) = length
  for (int k = 0; k < 200; ++k) {
    const double a = 0.5 * (lo + hi);
    (2.0 * a * std::sinh(0.5 * kSpan / a) > kLength ? lo : hi) = a;
  }
  return lo * (std::cosh(0.5 * kSpan / lo) - std::cosh((x - 0.5 * kSpan) / lo));
}

double distance_to_catenary(const Positions& x) {
  double worst = 0.0;
  for (int i = 0; i < x.cols(); ++i) {
    worst = std::max(worst, std::abs(x(2, i) + catenary_depth(x(0, i))));
  }
  return worst;
}

/// A chain that starts as a V, heavily damped.
std::unique_ptr<World> chain(int links, double dt, const std::string& solver) {
  Positions x = Positions::Zero(3, links + 1);
  const double depth = std::sqrt(0.25 * (kLength * kLength - kSpan * kSpan));
  std::vector<Spring> springs;
  for (int k = 0; k <= links; ++k) {
    const double s = 2.0 * std::abs(static_cast<double>(k) / links - 0.5);
    x.col(k) << kSpan * k / links, 0.0, -depth * (1.0 - s);
    if (k > 0) springs.push_back({k - 1, k, kLength / links, kStiffness * links / kLength});
  }
  auto model = std::make_unique<SystemModel>(x, kMass / links);
  model->add("stretch", springs);
  model->particles().fix(0);
  model->particles().fix(links);
  const int iterations = solver == "xpbd" ? 20 : 40;
  auto world = world_of(std::move(model), dt, solver, with_iterations(solver, iterations));
  world->add_effect(world->bodies().front(), effect_registry(), "gravity", {}, "test");
  world->add_effect(world->bodies().front(), effect_registry(), "damping", {{"rate", "6"}}, "test");
  return world;
}

class HangingChain : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(HangingChain);

TEST_P(HangingChain, ComesToRestAsStaticsSays) {
  const int links = 20;
  // Verlet's limit: 2 / omega = 2 / sqrt(4 k / m) = sqrt(m / k) = 5.8e-4 s.
  auto world = chain(links, 2e-4, solver());
  while (world->time() < 5.0) ASSERT_TRUE(world->step());
  const Particles& p = world->bodies().front().particles();
  const Positions exact = statics(links);
  // Sideways swinging is damped by exp(-3 t) = 3e-7; what iterations leave is below it.
  EXPECT_LE((p.x - exact).colwise().norm().maxCoeff(), 1e-6);
  EXPECT_LE(p.v.cwiseAbs().maxCoeff(), 1e-5);
  // The polygon is inscribed: 1/links² of the depth; the chain is longer by 1e-3.
  EXPECT_LE(distance_to_catenary(p.x), 0.3 * (1.0 / (links * links)) + 1.5e-3);
}

TEST(Catenary, IsTheLimitOfTheDiscreteChain) {
  // At n links the error is of the order 1/n²; the elastic part, about 1e-3 of the depth, stays.
  const double elastic = distance_to_catenary(statics(4000));
  EXPECT_LE(elastic, 2e-3);
  const double coarse = distance_to_catenary(statics(10)) - elastic;
  const double fine = distance_to_catenary(statics(20)) - elastic;
  EXPECT_GT(std::abs(coarse), std::abs(fine));
  EXPECT_NEAR(coarse / fine, 4.0, 1.0);
}

}  // namespace
}  // namespace pliant::catenary_test
