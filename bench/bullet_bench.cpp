// The same hanging cloth in Bullet's soft body and in Pliant's xpbd, side by side in one run.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hanging_cloth.h"

namespace pliant::bench {
namespace {

constexpr int kSide = 50;
constexpr int kSettlingSteps = 400;
constexpr float kTimeStep = 0.005f;

class BulletCloth {
 public:
  explicit BulletCloth(int iterations) {
    info_.m_broadphase = &broadphase_;
    info_.m_dispatcher = &dispatcher_;
    info_.m_gravity.setValue(0, 0, -9.81f);
    info_.m_sparsesdf.Initialize();
    // Structural links and one diagonal a cell, held at two corners.
    cloth_.reset(btSoftBodyHelpers::CreatePatch(info_, {-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0},
                                                {-0.5f, 0.5f, 0}, {0.5f, 0.5f, 0}, kSide, kSide,
                                                1 + 2, true));
    cloth_->setTotalMass(0.2f);
    cloth_->m_cfg.piterations = iterations;
    cloth_->m_cfg.collisions = 0;
  }

  void step() {
    cloth_->predictMotion(kTimeStep);
    cloth_->solveConstraints();
    cloth_->integrateMotion();
  }

  int links() const { return cloth_->m_links.size(); }

  Strain strain() const {
    Strain strain;
    int structural = 0;
    for (int k = 0; k < cloth_->m_links.size(); ++k) {
      const btSoftBody::Link& link = cloth_->m_links[k];
      const double rest = 1.0 / (kSide - 1);
      if (link.m_rl > 1.1 * rest) continue;  // a diagonal
      const double length = (link.m_n[0]->m_x - link.m_n[1]->m_x).length();
      const double size = std::abs(length / rest - 1.0);
      strain.mean += size;
      strain.max = std::max(strain.max, size);
      ++structural;
    }
    strain.mean /= structural;
    return strain;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSoftBodyWorldInfo info_;
  std::unique_ptr<btSoftBody> cloth_;
};

void set_counters(benchmark::State& state, const Strain& strain) {
  const double node_iterations = 1.0 * kSide * kSide * static_cast<double>(state.range(0)) *
                                 static_cast<double>(state.iterations());
  state.counters["node_iterations"] =
      benchmark::Counter(node_iterations, benchmark::Counter::kIsRate);
  state.counters["strain_mean"] = strain.mean;
  state.counters["strain_max"] = strain.max;
}

void bullet(benchmark::State& state) {
  BulletCloth cloth(static_cast<int>(state.range(0)));
  if (cloth.links() != 7301) state.SkipWithError("not the cloth to compare with");
  for (int k = 0; k < kSettlingSteps; ++k) cloth.step();
  for (auto _ : state) cloth.step();
  set_counters(state, cloth.strain());
}
BENCHMARK(bullet)->ArgName("iterations")->Arg(10);

void pliant_xpbd(benchmark::State& state) {
  HangingCloth options;
  options.solver_parameters = {{"iterations", std::to_string(state.range(0))}};
  const auto world = make_hanging_cloth(options);
  for (int k = 0; k < kSettlingSteps; ++k) world->step();
  for (auto _ : state) world->step();
  set_counters(state, stretch_strain(*world));
}
BENCHMARK(pliant_xpbd)->ArgName("iterations")->Arg(10)->Arg(20);

}  // namespace
}  // namespace pliant::bench

BENCHMARK_MAIN();
