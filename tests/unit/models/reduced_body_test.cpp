// A reduced body as a model of a world: what a world, its effects and a user do to it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/dense_factors.h"
#include "support/measures.h"
#include "support/worlds/drivers.h"
#include "support/worlds/reduced_worlds.h"

namespace pliant {
namespace {

ReducedScene swinging() {
  ReducedScene s;
  s.velocity = {0.0, 0.3, -0.5};
  s.effects = {{"gravity", {}}};
  return s;
}

/// Swings onto a ball and off again.
ReducedScene touching() {
  ReducedScene s = swinging();
  s.obstacles = {obstacle(Sphere(0.1), at(0.4, 0.02, -0.165))};
  s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {}}};
  return s;
}

/// R(q) = f by Newton's method.
Eigen::VectorXd static_solution(const QuarticPotential& potential, const Eigen::VectorXd& f) {
  QuarticPotential::Workspace space;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(f.size()), r;
  Eigen::MatrixXd k;
  for (int iteration = 0; iteration < 50; ++iteration) {
    potential.evaluate(q, r, k, space);
    q -= DenseCholesky(k).solve(Eigen::VectorXd(r - f));
  }
  return q;
}

TEST(ReducedBody, StandsWhereTheScenePutsIt) {
  ReducedScene s;
  s.pose = at(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  auto world = make_world(s);
  const Eigen::Matrix3Xd expected = s.pose * s.model->mesh.vertices;
  EXPECT_LE((particles_of(*world).x - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_NEAR(particles_of(*world).mass.sum(), 10.0, 1e-12);
  for (int i = 0; i < particles_of(*world).size(); ++i) {
    EXPECT_EQ(particles_of(*world).is_fixed(i), s.model->fixed[static_cast<std::size_t>(i)]);
  }
}

TEST(ReducedBody, ParticlesFollowTheCoordinates) {
  ReducedScene s = swinging();
  s.pose = at(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  auto world = make_world(s);
  run_for(*world, 0.2);
  const Eigen::Matrix3Xd expected = s.pose * s.model->positions(reduced_of(*world).q);
  EXPECT_LE((particles_of(*world).x - expected).cwiseAbs().maxCoeff(), 1e-13);
  // Displacement over time, to the order of the step.
  const Particles& particles = particles_of(*world);
  const Eigen::Matrix3Xd displacement = particles.x - particles.x_start;
  const Eigen::Matrix3Xd mean = 0.5 * s.time_step * (particles.v + particles.v_start);
  EXPECT_GT(displacement.cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LE((displacement - mean).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ReducedBody, InitialVelocityIsTheNearestOfTheBasis) {
  ReducedScene s = swinging();
  s.pose = at(0, 0, 0) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized());
  auto world = make_world(s);
  // Uᵀ M (v - U p) = 0
  const TetrahedralMesh& mesh = s.model->mesh;
  const StvkBody body(mesh, s.model->material, face_vertices(mesh), "test");
  Eigen::Matrix3Xd left = -particles_of(*world).v;
  for (int i = 0; i < left.cols(); ++i) {
    if (body.index(i) >= 0) left.col(i) += s.velocity;
  }
  left = s.pose.linear().transpose() * left;
  Eigen::VectorXd free(body.size());
  for (int i = 0; i < left.cols(); ++i) {
    if (body.index(i) >= 0) free.segment<3>(body.index(i)) = left.col(i);
  }
  const Eigen::VectorXd rest =
      s.model->basis.transpose() * body.expand(body.consistent_mass() * free);
  EXPECT_LE(rest.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT(reduced_of(*world).p.norm(), 0.1);
}

TEST(ReducedBody, SagsAsTheStaticSolution) {
  ReducedScene s;
  s.material = {{"alpha", "20"}};
  s.effects = {{"gravity", {}}};
  s.time_step = 0.01;
  auto world = make_world(s);
  run_for(*world, 20.0);
  const Eigen::Vector3d g(0, 0, -9.81);
  const Eigen::VectorXd f = s.model->reduced_force(g * particles_of(*world).mass.transpose());
  const Eigen::VectorXd q = static_solution(s.model->potential, f);
  EXPECT_GT(q.norm(), 0.1);
  EXPECT_LE((reduced_of(*world).q - q).norm(), 1e-7 * q.norm());
}

double work_error(const std::string& solver, double h) {
  ReducedScene s;
  s.solver = solver;
  s.time_step = h;
  auto world = make_world(s);
  AppliedForce force;
  force.point = {0.5, 0, 0};
  force.force = {0.0, 3.0, 5.0};
  force.radius = 0.1;
  force.duration = -1.0;
  world->applied_forces().add(force);
  double work = 0.0, worst = 0.0;
  while (world->time() < 0.5 - 0.5 * h) {
    EXPECT_TRUE(world->step());
    const Particles& particles = particles_of(*world);
    work += body_of(*world)
                .model->system()
                .external_forces.cwiseProduct(particles.x - particles.x_start)
                .sum();
    worst = std::max(worst, std::abs(world->energies().total() - work));
  }
  EXPECT_GT(work, 0.1);
  return worst / work;
}

TEST(ReducedBody, WorkOfAForceBecomesEnergyToTheSecondOrder) {
  for (const char* solver : {"trigonometric", "newmark", "midpoint", "stoermer_verlet"}) {
    const double coarse = work_error(solver, 0.0008), fine = work_error(solver, 0.0004);
    EXPECT_LE(coarse, 1e-2) << solver;
    EXPECT_LE(fine, 0.3 * coarse) << solver;
  }
}

/// The most energy that a body has while a force of 10 to 1000 kN presses it together, for 0.05 s,
/// and for a second after that, over the most work that the force had done.
double energy_over_work(const std::string& solver, double newtons) {
  ReducedScene s;
  s.solver = solver;
  s.time_step = 0.002;
  auto world = make_world(s);
  AppliedForce force;
  force.point = {0.5, 0, 0};
  force.force = {-newtons, 0.01 * newtons, 0};
  force.radius = 0.1;
  force.duration = 0.05;
  world->applied_forces().add(force);
  double work = 0.0, most_work = 0.0, most = 0.0;
  for (int k = 0; k < 500; ++k) {
    EXPECT_TRUE(world->step()) << solver << ": " << world->failure();
    const Particles& particles = particles_of(*world);
    const Forces& external = body_of(*world).model->system().external_forces;
    work += external.cwiseProduct(particles.x - particles.x_start).sum();
    most_work = std::max(most_work, work);
    most = std::max(most, world->energies().total());
  }
  return most / most_work;
}

TEST(ReducedBody, GainsNoEnergyWithoutBoundWhereItsMaterialCollapses) {
  for (const char* solver : {"trigonometric", "newmark", "midpoint", "reference"}) {
    for (const double newtons : {1e4, 1e5, 1e6}) {
      EXPECT_LE(energy_over_work(solver, newtons), 2.0) << solver << ", " << newtons << " N";
    }
  }
}

TEST(ReducedBody, StepsThatAreTooLongForAnExplicitIntegratorAreTold) {
  ReducedScene s;
  s.solver = "stoermer_verlet";
  const double fastest = std::sqrt(reduced_of(*make_world(s)).potential.lambda().maxCoeff());
  for (const double share : {0.99, 1.01}) {
    s.time_step = share * 2.0 / fastest;
    const auto world = make_world(s);
    ASSERT_TRUE(world->step());
    EXPECT_EQ(warns(*world, "unstable_step"), share > 1.0) << share;
  }
}

TEST(ReducedBody, CheckpointGoesOnBitForBit) {
  for (const std::string& solver : reduced_solvers()) {
    if (solver == "imex_thesis" || solver == "stoermer_verlet")
      continue;  // not stable at this step
    ReducedScene s = touching();
    s.solver = solver;
    auto world = make_world(s);
    while (body_of(*world).report.contacts == 0 && world->time() < 1.0) ASSERT_TRUE(world->step());
    ASSERT_GT(body_of(*world).report.contacts, 0) << solver;
    const Checkpoint checkpoint = world->save();
    run_for(*world, 0.2);
    const Positions x = particles_of(*world).x;
    const Eigen::VectorXd p = reduced_of(*world).p;
    world->load(checkpoint);
    run_for(*world, 0.2);
    EXPECT_EQ(particles_of(*world).x, x) << solver;
    EXPECT_EQ(reduced_of(*world).p, p) << solver;
  }
}

TEST(ReducedBody, ResetGoesBackBitForBit) {
  auto world = make_world(touching());
  const Eigen::VectorXd p = reduced_of(*world).p;
  run_for(*world, 0.3);
  const Positions x = particles_of(*world).x;
  world->reset();
  EXPECT_EQ(reduced_of(*world).q, Eigen::VectorXd::Zero(p.size()));
  EXPECT_EQ(reduced_of(*world).p, p);
  run_for(*world, 0.3);
  EXPECT_EQ(particles_of(*world).x, x);
}

TEST(ReducedBody, AStepThatIsUndoneLeavesNothing) {
  auto world = make_world(touching());
  run_for(*world, 0.2);
  const Eigen::VectorXd q = reduced_of(*world).q, p = reduced_of(*world).p;
  const Positions x = particles_of(*world).x;
  world->finite_check().max_speed = 1e-6;
  EXPECT_FALSE(world->step());
  EXPECT_EQ(reduced_of(*world).q, q);
  EXPECT_EQ(reduced_of(*world).p, p);
  EXPECT_EQ(particles_of(*world).x, x);
  EXPECT_NE(body_of(*world).report.failure.find("vertex"), std::string::npos);
}

TEST(ReducedBody, SwapInMotionKeepsTheCoordinates) {
  auto world = make_world(touching());
  for (const std::string& solver : reduced_solvers()) {
    run_for(*world, 0.05);
    const Eigen::VectorXd q = reduced_of(*world).q, p = reduced_of(*world).p;
    world->set_solver(body_of(*world), all_solvers(), solver, {}, "test");
    EXPECT_EQ(reduced_of(*world).q, q) << solver;
    EXPECT_EQ(reduced_of(*world).p, p) << solver;
    EXPECT_GT(p.norm(), 1e-3);
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body_of(*world).report.solver, solver);
    world->set_solver(body_of(*world), all_solvers(), "midpoint", {}, "test");
  }
}

TEST(ReducedBody, ThreadsChangeNothing) {
  const auto result = [](int count) {
    set_threads(count);
    ReducedScene s = touching();
    static const auto fine = std::make_shared<const ReducedModel>(*reduce(
        cantilever({{1.0, 0.1, 0.1}, {30, 4, 4}}, {4e5, 0.3, 1000.0}), {3, 6}, "fine", go_on));
    s.model = fine;
    auto world = make_world(s);
    run_for(*world, 0.3);
    return particles_of(*world).x;
  };
  const Positions one = result(1);
  EXPECT_EQ(result(3), one);
  set_threads(1);
}

TEST(ReducedBody, DampingEffectSlowsTheCoordinates) {
  ReducedScene s;
  s.velocity = {0, 0, 1};
  s.effects = {{"damping", {{"rate", "2"}}}};
  s.time_step = 1e-5;
  auto world = make_world(s);
  const double before = reduced_of(*world).kinetic_energy();
  ASSERT_TRUE(world->step());
  EXPECT_NEAR(reduced_of(*world).kinetic_energy() / before, std::exp(-4e-5), 1e-6);
  EXPECT_LE((particles_of(*world).v -
             Eigen::Matrix3Xd(s.model->positions(reduced_of(*world).p) - s.model->mesh.vertices))
                .cwiseAbs()
                .maxCoeff(),
            1e-12);
}

TEST(ReducedBody, FieldsOfAStretchedBlock) {
  ReducedScene s;
  s.model = stretching_block(1.0);
  s.pose = at(0, 0, 1) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY());
  auto world = make_world(s);
  const double e = 0.3;
  reduced_of(*world).q[0] = e;
  reduced_of(*world).move_particles();
  const auto fields = body_of(*world).model->point_fields();
  // F = diag(1 + e, 1, 1): σ₁ - σ₂ = (1 + e) S₁ - S₂/(1 + e).
  const double green = e + 0.5 * e * e, mu = 1e5 / 2.6, lambda = 3e4 / (1.3 * 0.4);
  const double s1 = (2.0 * mu + lambda) * green, s2 = lambda * green;
  const double expected = (1.0 + e) * s1 - s2 / (1.0 + e);
  for (int i = 0; i < particles_of(*world).size(); ++i) {
    EXPECT_NEAR(fields.at("von_mises")[i], expected, 1e-9 * expected);
    EXPECT_NEAR(fields.at("displacement")[i], e * std::abs(s.model->mesh.vertices(0, i)), 1e-12);
  }
}

TEST(ReducedBody, WarnsOfCompressionWithinARound) {
  for (const bool strong : {false, true}) {
    ReducedScene s;
    s.model = stretching_block(1e-12);
    auto world = make_world(s);
    reduced_of(*world).q[0] = strong ? -0.45 : -0.40;  // 0.55 and 0.60 of the length
    reduced_of(*world).move_particles();
    bool warned = false;
    for (int k = 0; k < StretchWatch::kRound; ++k) {
      ASSERT_TRUE(world->step());
      for (const std::string& text : body_of(*world).report.warnings) {
        warned |= text.find("stvk_compression") == 0;
      }
    }
    EXPECT_EQ(warned, strong);
  }
}

double metric(const StepReport& report, const std::string& name) {
  for (const Metric& metric : report.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "no metric " << name;
  return 0.0;
}

TEST(ReducedBody, HighFrequencyEnergyIsThatOfFastCoordinates) {
  ReducedScene s = swinging();
  s.effects.clear();
  const auto& lambda = s.model->potential.lambda();
  const double between = std::sqrt(std::sqrt(lambda[3] * lambda[4])) / (2.0 * M_PI);  // [Hz]
  s.material = {{"fast_frequency", std::to_string(between)}};
  auto world = make_world(s);
  EXPECT_EQ(reduced_of(*world).first_fast(s.time_step), 4);
  run_for(*world, 0.1);
  const ReducedBodySystem& system = reduced_of(*world);
  double expected = 0.0;
  for (int i = 4; i < 10; ++i) {
    expected += 0.5 * system.p[i] * system.p[i] + 0.5 * lambda[i] * system.q[i] * system.q[i];
  }
  EXPECT_GT(expected, 0.0);
  EXPECT_NEAR(metric(body_of(*world).report, "high_frequency_energy"), expected, 1e-12 * expected);
  // Without a frequency, h ω >= 1 counts.
  ReducedScene other = swinging();
  other.time_step = 1.0 / std::sqrt(std::sqrt(lambda[5] * lambda[6]));
  auto second = make_world(other);
  EXPECT_EQ(reduced_of(*second).first_fast(other.time_step), 6);
}

TEST(ReducedBody, RotatedSceneGivesTheRotatedResult) {
  const Eigen::Isometry3d turn =
      at(0.3, -2, 1) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 0.5).normalized());
  ReducedScene s = touching();
  auto plain = make_world(s);
  run_for(*plain, 0.3);
  const Eigen::Vector3d g = turn.linear() * Eigen::Vector3d(0, 0, -9.81);
  s.pose = turn * s.pose;
  s.velocity = turn.linear() * s.velocity;
  s.obstacles.front().pose_start = s.obstacles.front().pose_end =
      turn * s.obstacles.front().pose_end;
  s.effects.front().second = {
      {"acceleration", fmt::format("[{:.17g}, {:.17g}, {:.17g}]", g.x(), g.y(), g.z())}};
  auto turned = make_world(s);
  run_for(*turned, 0.3);
  EXPECT_GT(body_of(*plain).report.contacts, 0);
  // Tangents of a contact are chosen by world axes, and Gauss-Seidel ends at 1e-7 of the offset.
  EXPECT_LE((particles_of(*turned).x - turn * particles_of(*plain).x).cwiseAbs().maxCoeff(), 1e-6);
}

/// A body of 8 kg that moves as a whole: each column of `motions` is a displacement of its vertices
/// that has unit mass.
std::shared_ptr<const ReducedModel> whole_body(const TetrahedralMesh& mesh,
                                               const Eigen::MatrixXd& motions) {
  auto model = std::make_shared<ReducedModel>();
  model->name = "whole";
  model->mesh = mesh;
  model->material = {1e5, 0.3, 8.0 / vertex_volumes(mesh).sum()};
  model->fixed.assign(static_cast<std::size_t>(mesh.vertices.cols()), false);
  model->basis = motions;
  const auto rank = static_cast<int>(motions.cols());
  model->potential = QuarticPotential(
      Eigen::VectorXd::Zero(rank),
      std::vector<double>(static_cast<std::size_t>(QuarticPotential::coefficient_count(rank))),
      "whole");
  return model;
}

/// A tetrahedron on its tip, 1 mm above a floor, that only shifts, with an inertia of its own in
/// each axis [kg].
ReducedScene on_a_tip(const Eigen::Vector3d& inertia) {
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0.0, 0.2, -0.1, -0.1,  //
      0.0, 0.0, 0.2, -0.2,                //
      0.0, 0.2, 0.2, 0.2;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  Eigen::MatrixXd shifts(12, 3);
  for (int v = 0; v < 4; ++v) {
    shifts.middleRows<3>(3 * v) = inertia.cwiseSqrt().cwiseInverse().asDiagonal();
  }
  ReducedScene s;
  s.model = whole_body(mesh, shifts);
  s.obstacles = {obstacle(Box(Eigen::Vector3d(0.4, 0.4, 0.1)), at(0, 0, -0.051))};
  return s;
}

TEST(ReducedBody, AHitSlowsTheSlipByTheConeOfAllThatStopsTheFall) {
  // The tip falls onto the floor in the first step, with slip enough to go on: Coulomb's friction
  // takes μ times the speed of the fall from it, however the step shares out force and impulse.
  for (const double share : {0.25, 0.5, 0.75}) {  // of the step that passes before the hit
    ReducedScene s = on_a_tip({8.0, 8.0, 8.0});
    s.velocity = {2.0, 0.0, -1.0};
    s.pose = at(0, 0, share * s.time_step);
    s.effects = {{"contact", {}}, {"friction", {{"coefficient", "0.3"}}}};
    auto world = make_world(s);
    ASSERT_TRUE(world->step());
    ASSERT_GT(body_of(*world).report.contacts, 0);
    // Contacts are soft by a thousandth.
    const Eigen::Vector3d v = particles_of(*world).v.col(0);
    EXPECT_NEAR(v.x(), 2.0 - 0.3, 1e-3) << share;
    EXPECT_NEAR(v.y(), 0.0, 1e-9) << share;
    EXPECT_NEAR(v.z(), 0.0, 1e-3) << share;
  }
}

TEST(ReducedBody, APushWithinTheConeMovesNoPointThatSticks) {
  // However differently the body answers along the two tangents.
  for (const double sideways : {8.0, 32.0}) {
    ReducedScene s = on_a_tip({8.0, sideways, 8.0});
    s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "10"}}}};
    auto world = make_world(s);
    run_for(*world, 0.1);
    ASSERT_GT(body_of(*world).report.contacts, 0);
    const double speed = 0.01;
    reduced_of(*world).p += speed * Eigen::Vector3d(std::sqrt(8.0), std::sqrt(sideways), 0.0);
    ASSERT_TRUE(world->step());
    const Particles& particles = particles_of(*world);
    const Eigen::Vector3d displacement = particles.x.col(0) - particles.x_start.col(0);
    // A contact gives way by a thousandth of what the most mobile one would: four of the heavy
    // axis's own displacement.
    EXPECT_LE(displacement.cwiseAbs().maxCoeff(), 5e-3 * speed * s.time_step) << sideways;
    EXPECT_LE(particles.v.col(0).cwiseAbs().maxCoeff(), 5e-3 * speed) << sideways;
  }
}

TEST(ReducedBody, ABlockThatLandsFlatDoesNotTilt) {
  // It can rise and tilt about y; inertia of a cube of 8 kg with edges of 0.2 m.
  const double edge = 0.2, mass = 8.0, inertia = mass * edge * edge / 6.0;
  const TetrahedralMesh mesh = make_block({{edge, edge, edge}, {1, 1, 1}});
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * mesh.vertices.cols(), 2);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    motions(3 * v + 2, 0) = 1.0 / std::sqrt(mass);
    motions.block<3, 1>(3 * v, 1) =
        Eigen::Vector3d::UnitY().cross(Eigen::Vector3d(mesh.vertices.col(v))) / std::sqrt(inertia);
  }
  ReducedScene s;
  s.model = whole_body(mesh, motions);
  s.velocity = {0.0, 0.0, -1.0};
  s.obstacles = {obstacle(Box(Eigen::Vector3d(0.4, 0.4, 0.1)), at(0, 0, -0.1 - 0.0515))};
  s.effects = {{"contact", {}}};
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  ASSERT_EQ(body_of(*world).report.contacts, 4);
  // Contacts are soft by a thousandth.
  EXPECT_LE(particles_of(*world).v.cwiseAbs().maxCoeff(), 2e-3);
}

TEST(ReducedBody, RefusesWhatIsNotReduced) {
  const auto& entry = model_registry().find("reduced");
  try {
    entry.make(parse_parameters(entry.parameters, {}, "test"), BodyGeometry());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("reduced_model"), std::string::npos) << error.what();
  }
}

TEST(ReducedBody, SolversOfOtherModelsAreRefused) {
  auto world = make_world(ReducedScene());
  for (const char* name : {"xpbd", "newton"}) {
    try {
      world->set_solver(body_of(*world), all_solvers(), name, {}, "test");
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("trigonometric"), std::string::npos) << error.what();
    }
  }
  auto cloth = make_world(ClothScene());
  EXPECT_THROW(cloth->set_solver(body_of(*cloth), all_solvers(), "trigonometric", {}, "test"),
               InputError);
  EXPECT_EQ(body_of(*world).solver->name(), "midpoint");
}

}  // namespace
}  // namespace pliant
