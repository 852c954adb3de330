#pragma once

#include <cmath>

#include "pliant/models/viscoelastic/liquid.h"
#include "support/random.h"

namespace pliant {

/// Two liquids side by side, squeezed and in motion, partly solid.
struct LiquidSample {
  static constexpr int kSide = 9;
  static constexpr double kSpacing = 0.01;  // [m]

  LiquidSample() {
    Random random(4);
    const int n = kSide * kSide * kSide;
    Positions x(3, n);
    for (int i = 0; i < n; ++i) {
      x.col(i) =
          0.93 * kSpacing * Eigen::Vector3d(i % kSide, i / kSide % kSide, i / (kSide * kSide));
    }
    x += random.positions(n, 0.1 * kSpacing);
    x.colwise() += Eigen::Vector3d(3.0, -2.0, 0.0);
    volumes = Eigen::VectorXd::Constant(n, std::pow(kSpacing, 3));
    particles = Particles(x, 1000.0 * volumes);
    particles.v = random.positions(n, 1.0);
    beta = (random.positions(n, 1.0).row(0).transpose().array() + 0.5).max(0.0).min(1.0);
  }

  void add_to(Liquid& liquid) const {
    const Eigen::Index half = volumes.size() / 2;
    liquid.add_part(volumes.head(half), {1000.0, 5.0, 0.1});
    liquid.add_part(volumes.tail(volumes.size() - half), {800.0, 7.0, 0.3});
  }

  Particles particles;
  Eigen::VectorXd beta, volumes;
};

}  // namespace pliant
