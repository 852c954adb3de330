// The inverse between particles that constraints touch, against the same of all particles.
#include "pliant/solvers/constrained/touched_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pliant/math/dense_factors.h"
#include "support/random.h"

namespace pliant {
namespace {

constexpr int kParticles = 30, kOfABody = 12;  // two free bodies, and six particles that are held

struct Bodies {
  Bodies() : x(Random(3).positions(kParticles, 0.2)), inertia(kParticles) {
    Random random(5);
    Eigen::MatrixXd mixed(kParticles, kParticles);
    for (int i = 0; i < kParticles; ++i) {
      inertia[i] = random(0.5, 2.0);
      for (int j = 0; j < kParticles; ++j) {
        mixed(i, j) = i / kOfABody == j / kOfABody ? random(-1.0, 1.0) : 0.0;
      }
    }
    a = 3.0 * mixed * mixed.transpose();
    a.diagonal() += inertia;
    factor.compute(a);

    Components components;
    components.members.resize(kParticles);
    std::iota(components.members.begin(), components.members.end(), 0);
    for (int i = 0; i < kParticles; ++i) components.of.push_back(i / kOfABody);
    components.begins = {0, kOfABody, 2 * kOfABody, kParticles};
    components.held = {false, false, true};
    components.twisted = {false, false, false};
    modes.prepare(components, inertia);
    modes.update(x);
  }

  /// Counts how often it is asked.
  LinearOperator inverse() {
    return [this](Eigen::Matrix3Xd& v) {
      ++solved;
      for (int k = 0; k < 3; ++k) {
        Eigen::VectorXd side = v.row(k);
        factor.solve_in_place(side);
        v.row(k) = side;
      }
    };
  }

  void add_pairs(int count, std::uint64_t seed, QuasiNewtonPairs& pairs) const {
    Random random(seed);
    for (int k = 0; k < count; ++k) {
      auto& pair = pairs.next();
      pair.s = random.positions(kParticles, 0.01);
      pair.y = pair.s * a + random.positions(kParticles, 0.002);
      pairs.add_next();
    }
  }

  /// B f of all particles.
  Positions whole(QuasiNewtonPairs* pairs, Forces f) {
    const LinearOperator a_inverse = inverse();
    modes.take_out(f);
    if (pairs != nullptr) {
      pairs->apply(a_inverse, f);
    } else {
      a_inverse(f);
    }
    modes.put_in(f);
    return f;
  }

  Positions x;
  Eigen::VectorXd inertia;
  Eigen::MatrixXd a;
  DenseLdlt factor;
  RigidModes modes;
  int solved = 0;
};

/// `touched` against all of B, at forces on these particles.
void expect_equal(Bodies& bodies, TouchedInverse& touched, QuasiNewtonPairs* pairs,
                  const std::vector<int>& particles) {
  ASSERT_TRUE(touched.restrict_to(particles, 1));
  Random random(9);
  Forces f = Forces::Zero(3, kParticles);
  Eigen::Matrix4Xd own = Eigen::Matrix4Xd::Zero(4, static_cast<Eigen::Index>(particles.size()));
  for (std::size_t k = 0; k < particles.size(); ++k) {
    f.col(particles[k]) = random.vector(1.0);
    own.col(static_cast<Eigen::Index>(k)).head<3>() = f.col(particles[k]);
  }
  Eigen::Matrix4Xd answers;
  touched.apply(own, answers);
  const Positions expected = bodies.whole(pairs, f);
  const double size = expected.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Eigen::Vector4d answer = answers.col(static_cast<Eigen::Index>(k));
    EXPECT_LT((answer.head<3>() - expected.col(particles[k])).norm(), 1e-12 * size) << particles[k];
    EXPECT_EQ(answer[3], 0.0);
  }
}

TEST(TouchedInverse, IsThatOfAllParticles) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, 1000, bodies.inverse());
  // Of one body, of both, of what is held, and all.
  const std::vector<std::vector<int>> choices = {
      {1, 4, 5}, {0, 11, 12, 23}, {25, 28}, {2, 3, 7, 13, 14, 15, 20, 24, 29}};
  for (const std::vector<int>& particles : choices) {
    touched.begin_correction(bodies.modes, nullptr);
    expect_equal(bodies, touched, nullptr, particles);
  }
}

TEST(TouchedInverse, HasWhatQuasiNewtonLearned) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, 1000, bodies.inverse());
  QuasiNewtonPairs pairs(5);
  for (int correction = 0; correction < 8; ++correction) {  // the ring goes round
    bodies.add_pairs(correction == 0 ? 0 : 1, 20 + static_cast<std::uint64_t>(correction), pairs);
    ASSERT_EQ(pairs.size(), std::min(correction, 5));
    bodies.x += Random(40 + static_cast<std::uint64_t>(correction)).positions(kParticles, 0.05);
    bodies.modes.update(bodies.x);
    touched.begin_correction(bodies.modes, &pairs);
    expect_equal(bodies, touched, &pairs, {0, 3, 8, 13, 22, 26});
    expect_equal(bodies, touched, &pairs, {3, 8, 26});  // the next round's
  }
}

TEST(TouchedInverse, KnowsWhatParticlesAnswerThemselves) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, 1000, bodies.inverse());
  const Eigen::MatrixXd inverse = bodies.a.inverse();
  const std::vector<int> asked = {25, 4, 7, 0};
  const std::vector<double> own = touched.own(asked);
  ASSERT_EQ(own.size(), asked.size());
  for (std::size_t k = 0; k < asked.size(); ++k) {
    EXPECT_NEAR(own[k], inverse(asked[k], asked[k]), 1e-12);
  }
  EXPECT_EQ(bodies.solved, 2);  // three at once
}

TEST(TouchedInverse, AsksForEachColumnOnce) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, 1000, bodies.inverse());
  const auto solutions_of = [&](const std::vector<int>& particles) {
    const int before = bodies.solved;
    touched.begin_correction(bodies.modes, nullptr);
    EXPECT_TRUE(touched.restrict_to(particles, 1));
    return bodies.solved - before;
  };
  EXPECT_EQ(solutions_of({4, 7, 25}), 3);  // three columns at once, and two for rigid modes
  EXPECT_EQ(solutions_of({4, 7, 25}), 1);  // where their arms are now
  EXPECT_EQ(solutions_of({4, 8, 25}), 2);
  EXPECT_EQ(solutions_of({7, 8}), 1);
}

TEST(TouchedInverse, IsThatOfSomeOfItsParticles) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, 1000, bodies.inverse());
  QuasiNewtonPairs pairs(5);
  bodies.add_pairs(3, 7, pairs);
  touched.begin_correction(bodies.modes, &pairs);
  const std::vector<int> particles = {2, 3, 7, 13, 15, 24, 29};
  ASSERT_TRUE(touched.restrict_to(particles, 3));
  // In any order, and other ones after that, while all of them are there too.
  for (const std::vector<int>& places : {std::vector<int>{5, 0, 3}, {1}, {6, 4, 2, 1}}) {
    touched.select(places);
    Random random(11);
    Forces f = Forces::Zero(3, kParticles);
    Eigen::Matrix4Xd own = Eigen::Matrix4Xd::Zero(4, static_cast<Eigen::Index>(places.size()));
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Eigen::Vector3d force = random.vector(1.0);
      f.col(particles[static_cast<std::size_t>(places[k])]) = force;
      own.col(static_cast<Eigen::Index>(k)).head<3>() = force;
    }
    Eigen::Matrix4Xd answers;
    touched.apply_selected(own, answers);
    const Positions expected = bodies.whole(&pairs, f);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const int particle = particles[static_cast<std::size_t>(places[k])];
      const Eigen::Vector4d answer = answers.col(static_cast<Eigen::Index>(k));
      EXPECT_LT((answer.head<3>() - expected.col(particle)).norm(),
                1e-12 * expected.cwiseAbs().maxCoeff());
      EXPECT_EQ(answer[3], 0.0);
    }
    expect_equal(bodies, touched, &pairs, particles);
  }
}

// Two that are selected are as quick as a factor of one entry, and three times as many may touch.
constexpr Eigen::Index kSmallFactor = 1;

TEST(TouchedInverse, KeepsNoMoreColumnsThanItMayNeed) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, kSmallFactor, bodies.inverse());  // twelve are kept
  for (const std::vector<int>& particles :
       {std::vector<int>{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}, {12, 13, 14}, {0, 1, 2, 3}}) {
    touched.begin_correction(bodies.modes, nullptr);
    expect_equal(bodies, touched, nullptr, particles);
  }
}

TEST(TouchedInverse, IsLeftAloneWhereTheFactorIsAsQuick) {
  Bodies bodies;
  TouchedInverse touched;
  touched.prepare(kParticles, kSmallFactor, bodies.inverse());
  touched.begin_correction(bodies.modes, nullptr);
  EXPECT_TRUE(touched.restrict_to({0, 1, 2, 3, 4, 5}, 2));
  EXPECT_FALSE(touched.restrict_to({0, 1, 2, 3, 4, 5, 6}, 2));
  EXPECT_FALSE(touched.restrict_to({0, 1, 2, 3, 4, 5}, 3));
}

}  // namespace
}  // namespace pliant
