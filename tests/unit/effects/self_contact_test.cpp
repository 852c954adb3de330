// What self_contact sees at rest and what contacts it finds.
#include "pliant/effects/self_contact/self_contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/self_contact/self_contact_detection.h"
#include "pliant/geometry/distance/barycentric.h"
#include "pliant/geometry/meshing/embedding.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/worlds/solid_world.h"
#include "support/worlds/worlds.h"

namespace pliant::self_contact_test {
namespace {

const BlockOptions kBlock{{0.1, 0.1, 0.1}, {4, 4, 4}};

/// A block with another one above it, `gap` apart.
SolidScene two_blocks(double gap) {
  SolidScene scene;
  SolidPart lower{make_block(kBlock)}, upper{make_block({{0.05, 0.05, 0.05}, {2, 2, 2}})};
  upper.pose.translation() << 0.004, 0.003, 0.075 + gap;
  scene.parts = {lower, upper};
  return scene;
}

SelfContactParts parts_of(const SolidModel& model) {
  return {*model.tetrahedra(), model.surface_triangles(), nullptr, nullptr};
}

/// The contacts of particles that do not move.
std::vector<PairContact> contacts_at_rest(const SolidScene& scene, double dt = 0.005) {
  SolidModel model(scene.parts);
  model.particles().x_start = model.particles().x;
  SelfContactDetection detection(parts_of(model), {0.002, 0.0005, 0.5});
  std::vector<PairContact> contacts;
  detection.find(model.particles(), dt, contacts);
  return contacts;
}

TEST(SelfContactParts, AreJoinedByTetrahedra) {
  const SolidModel model(two_blocks(0.01).parts);
  const SelfContactParts parts = parts_of(model);
  for (int i = 0; i < model.particles().size(); ++i) {
    EXPECT_EQ(parts.part_of_particle(i), i < model.first(1) ? 0 : 1);
  }
  // Boundaries: 6 sides of 4 x 4 or 2 x 2 cells, two triangles each, and their vertices.
  EXPECT_EQ(parts.triangles().size(), 6u * 16 * 2 + 6 * 4 * 2);
  EXPECT_EQ(parts.points().size(), (125 - 27) + (27 - 1));
  EXPECT_EQ(parts.bulge(), 0.0);
  for (const EmbeddedTriangle& triangle : parts.triangles()) {
    const Eigen::Matrix3d corners = triangle.corners(model.tetrahedra()->vertices);
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    EXPECT_GT(normal.dot(corners.rowwise().mean()), 0.0) << "faces inwards";
  }
}

TEST(SelfContactParts, TakeTheSurfaceThatTheParticlesCarry) {
  // The block's boundary, 3 mm farther out.
  const TetrahedralMesh mesh = make_block(kBlock);
  Eigen::Matrix3Xd outer = mesh.vertices;
  for (double& value : outer.reshaped()) {
    if (std::abs(value) > 0.049) value += value > 0.0 ? 0.003 : -0.003;
  }
  const Embedding embedding = embed(outer, mesh);
  Eigen::Matrix4Xi carriers(4, outer.cols());
  for (int i = 0; i < outer.cols(); ++i) {
    carriers.col(i) = mesh.tetrahedra.col(embedding.tetrahedron[i]);
  }
  const EmbeddedPoints surface(carriers, embedding.weights);
  const SelfContactParts parts(mesh, boundary_triangles(mesh), &surface, &surface);
  EXPECT_EQ(parts.points().size(), outer.cols());
  EXPECT_GE(parts.bulge(), 0.003 - 1e-12);
  const NearestTriangle::Result nearest = parts.nearest(0, Eigen::Vector3d(0.01, 0.02, 0.045));
  EXPECT_NEAR(nearest.distance, 0.008, 1e-9);
  EXPECT_NEAR(nearest.point[2], 0.053, 1e-9);
}

TEST(SelfContactParts, RefuseBadMeshes) {
  TetrahedralMesh mesh = make_block(kBlock);
  std::swap(mesh.tetrahedra(0, 7), mesh.tetrahedra(1, 7));
  expect_refusal([&] { SelfContactParts(mesh, Eigen::Matrix3Xi(3, 0), nullptr, nullptr); },
                 {"self_contact: 1", "inverted", ": 7"});
}

TEST(SelfContactDetection, FindsNothingBeyondThicknessAndMotion) {
  EXPECT_FALSE(contacts_at_rest(two_blocks(0.002)).empty());
  // Nearer than the triangles are long, but nothing moves.
  EXPECT_TRUE(contacts_at_rest(two_blocks(0.005)).empty());
}

TEST(SelfContactDetection, TakesEachPointByItsOwnMotion) {
  // The upper block's top moved down by as much as the gap and more, its bottom did not.
  SolidModel model(two_blocks(0.005).parts);
  Particles& particles = model.particles();
  particles.x_start = particles.x;
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.x(2, i) > 0.09) particles.x_start(2, i) += 0.02;
  }
  SelfContactDetection detection(parts_of(model), {0.002, 0.0005, 0.5});
  std::vector<PairContact> contacts;
  detection.find(particles, 0.005, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(SelfContactDetection, FindsWhatIsNearAndHowFar) {
  const std::vector<PairContact> contacts = contacts_at_rest(two_blocks(0.0015));
  // The nine vertices of the upper block, and the lower one's under it.
  EXPECT_GE(contacts.size(), 9u);
  for (const PairContact& contact : contacts) {
    EXPECT_NEAR(std::abs(contact.normal[2]), 1.0, 1e-9);
    // Both places are one; 0.5 mm are missing.
    EXPECT_LE(contact.start.norm(), 1e-12);
    EXPECT_NEAR(contact.least, 0.0005, 1e-12);
    double sum = 0.0;
    for (double weight : contact.weights) sum += weight;
    EXPECT_NEAR(sum, 0.0, 1e-12);
  }
  EXPECT_FALSE(contacts_at_rest(two_blocks(0.0024)).empty()) << "within the margin";
  EXPECT_TRUE(contacts_at_rest(two_blocks(0.0026)).empty());
}

TEST(SelfContactDetection, OpensAnOverlapNoFasterThanAMetrePerSecond) {
  for (const double depth : {0.001, 0.012}) {
    const std::vector<PairContact> contacts = contacts_at_rest(two_blocks(-depth), 1e-3);
    ASSERT_FALSE(contacts.empty());
    for (const PairContact& contact : contacts) {
      EXPECT_LE(contact.least - contact.normal.dot(contact.start), 1e-3 + 1e-12) << depth;
      EXPECT_GT(std::abs(contact.normal[2]), 0.9) << depth;
    }
  }
}

// A block with one deep in its top and another deep in its side: each pair leaves along its own
// direction.
TEST(SelfContactDetection, EachPairOfPartsLeavesAlongItsOwnDirection) {
  SolidScene scene = two_blocks(-0.012);
  SolidPart aside = scene.parts[1];
  aside.pose = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitY()) * aside.pose;
  scene.parts.push_back(aside);
  const SolidModel model(scene.parts);
  const auto part_of = [&](int particle) {
    return particle < model.first(1) ? 0 : particle < model.first(2) ? 1 : 2;
  };
  int above = 0, beside = 0;
  for (const PairContact& contact : contacts_at_rest(scene)) {
    const int point = part_of(contact.particles[0]), surface = part_of(contact.particles[4]);
    ASSERT_EQ(std::min(point, surface), 0) << "the two others are apart";
    const int other = std::max(point, surface);
    // From the block to the other part.
    const Eigen::Vector3d out = (point == 0 ? -1.0 : 1.0) * contact.normal;
    EXPECT_GT(other == 1 ? out.z() : out.x(), 0.9) << other << ": " << out.transpose();
    ++(other == 1 ? above : beside);
  }
  EXPECT_GT(above, 0);
  EXPECT_GT(beside, 0);
}

/// The contacts of a block with a slit that is `gap` wide at rest and `now` where it is open.
std::vector<PairContact> contacts_in_a_slit(double gap, double now) {
  TetrahedralMesh mesh = make_block({{0.1, 0.1, 0.09}, {4, 4, 3}});
  for (auto place : mesh.vertices.colwise()) {
    const double out = std::abs(place.z()) > 0.03 ? 0.03 : 0.0;
    place.z() = std::copysign(out + 0.5 * gap, place.z());
  }
  // Of the middle layer the first of four columns is left.
  TetrahedralMesh slit = mesh;
  Eigen::Index kept = 0;
  for (const auto tetrahedron : mesh.tetrahedra.colwise()) {
    const Eigen::Vector3d middle = corners_of(mesh.vertices, tetrahedron).rowwise().mean();
    if (std::abs(middle.z()) < 0.5 * gap && middle.x() > -0.025) continue;
    slit.tetrahedra.col(kept++) = tetrahedron;
  }
  slit.tetrahedra.conservativeResize(4, kept);
  SolidModel model({{slit}});
  for (auto place : model.particles().x.colwise()) {
    if (place.z() > 0.0 && place.x() > -0.01) place.z() -= gap - now;
  }
  model.particles().x_start = model.particles().x;
  SelfContactDetection detection(parts_of(model), {0.002, 0.0005, 0.5});
  std::vector<PairContact> contacts;
  detection.find(model.particles(), 0.005, contacts);
  return contacts;
}

TEST(SelfContactDetection, SidesOfASlitThatIsNarrowAtRestAreNeighbours) {
  EXPECT_FALSE(contacts_in_a_slit(0.0044, 0.001).empty());
  EXPECT_TRUE(contacts_in_a_slit(0.0044, 0.0024).empty()) << "more than half of what it was";
  // Less than twice the thickness.
  EXPECT_TRUE(contacts_in_a_slit(0.0036, 0.001).empty());
  EXPECT_TRUE(contacts_in_a_slit(0.0024, 0.001).empty());
}

TEST(SelfContactDetection, ABodyByItselfTouchesNothing) {
  SolidScene scene;
  scene.parts = {{make_block(kBlock)}};
  EXPECT_TRUE(contacts_at_rest(scene).empty());
  // Nor where it is pressed to two thirds.
  SolidModel model(scene.parts);
  model.particles().x.row(2) *= 0.67;
  model.particles().x_start = model.particles().x;
  SelfContactDetection detection(parts_of(model), {0.002, 0.0005, 0.5});
  std::vector<PairContact> contacts;
  detection.find(model.particles(), 0.005, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(SelfContactDetection, SurvivesWhatIsNotFinite) {
  SolidModel model(two_blocks(0.0015).parts);
  model.particles().x_start = model.particles().x;
  SelfContactDetection detection(parts_of(model), {0.002, 0.0005, 0.5});
  std::vector<PairContact> contacts;
  for (const double bad : {std::nan(""), 1e300, double(INFINITY)}) {
    model.particles().x.col(model.first(1) + 3).setConstant(bad);
    detection.find(model.particles(), 0.005, contacts);
  }
  model.particles().x.setZero();
  detection.find(model.particles(), 0.005, contacts);
  model.particles().x = model.particles().x_start;
  detection.find(model.particles(), 0.005, contacts);
  EXPECT_EQ(contacts.size(), contacts_at_rest(two_blocks(0.0015)).size());
}

/// Positions after some steps on so many threads.
Positions after_steps(int thread_count) {
  set_threads(thread_count);
  SolidScene scene = two_blocks(-0.012);
  scene.effects = {{"gravity", {}}, {"self_contact", {}}};
  scene.solver = "chebyshev";
  scene.solver_parameters = {};
  auto world = make_solid_world(scene);
  for (int step = 0; step < 20; ++step) EXPECT_TRUE(world->step()) << world->failure();
  set_threads(1);
  return particles_of(*world).x;
}

/// One sweep after the other over all pairs, each from where the one before it left all.
Positions separated_in_turn(const std::vector<PairContact>& contacts,
                            const Eigen::VectorXd& mobility, double thickness, Positions x) {
  for (int sweep = 0; sweep < 100; ++sweep) {
    double deepest = 0.0;
    for (const PairContact& contact : contacts) {
      double own = 0.0;
      for (std::size_t k = 0; k < contact.count; ++k) {
        own += contact.weights[k] * contact.weights[k] * mobility[contact.particles[k]];
      }
      const double missing = contact.least - contact.normal.dot(contact.relative(x));
      if (own == 0.0 || !(missing > 0.0)) continue;
      deepest = std::max(deepest, missing);
      const Eigen::Vector3d force = missing / own * contact.normal;
      for (std::size_t k = 0; k < contact.count; ++k) {
        const int i = contact.particles[k];
        x.col(i) += contact.weights[k] * mobility[i] * force;
      }
    }
    if (deepest <= 0.1 * thickness) break;
  }
  return x;
}

TEST(PairContacts, AreSeparatedOneAfterTheOtherInAnyNumberOfThreads) {
  constexpr int kParticles = 900, kPairs = 2500;
  constexpr double kThickness = 0.004;  // [m]
  Random random(4);
  const Positions start = random.positions(kParticles, 0.05);
  Eigen::VectorXd mobility = Eigen::VectorXd::Ones(kParticles);
  mobility.head(50).setZero();
  PairContacts pairs(kThickness, 1);
  for (int p = 0; p < kPairs; ++p) {
    PairContact pair;
    pair.count = 4;
    pair.particles.fill(0);
    pair.start.setZero();
    const double a = random(0, 1), b = random(0, 1 - a);
    pair.weights = {1.0, -a, -b, a + b - 1.0};
    const int first = p < 20 ? 4 * (p % 10) : static_cast<int>(random(0, kParticles - 4));
    for (int k = 0; k < 4; ++k) pair.particles[static_cast<std::size_t>(k)] = first + k;
    pair.normal = random.vector(1.0).normalized();
    // Most are far enough apart.
    pair.least = pair.normal.dot(pair.relative(start)) + random(-0.04, 0.004);
    pairs.all().push_back(pair);
  }
  const Positions expected = separated_in_turn(pairs.all(), mobility, kThickness, start);
  EXPECT_GT((expected - start).norm(), 0.01);
  const std::vector<PairContact> all = pairs.all();
  for (const int count : {1, 3}) {
    set_threads(count);
    pairs.all() = all;
    Positions x = start;
    pairs.separate(mobility, x);
    set_threads(1);
    EXPECT_TRUE(x == expected) << count << " threads";
  }
}

TEST(SelfContactEffect, ThreadsDoNotChangeABit) {
  const Positions one = after_steps(1);
  EXPECT_EQ(one, after_steps(2));
  EXPECT_EQ(one, after_steps(4));
}

TEST(SelfContactEffect, ResetAndCheckpointsGoOnBitForBit) {
  SolidScene scene = two_blocks(0.001);
  scene.effects = {{"gravity", {}}, {"self_contact", {}}};
  scene.solver = "direct";
  scene.solver_parameters = {};
  auto world = make_solid_world(scene);
  const auto run = [&](int steps) {
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step()) << world->failure();
    return particles_of(*world).x;
  };
  const Positions first = run(8);
  const Checkpoint checkpoint = world->save();
  const Positions later = run(8);
  world->load(checkpoint);
  EXPECT_EQ(run(8), later);
  world->reset();
  EXPECT_EQ(run(8), first);
}

TEST(SelfContactEffect, RefusesBadParameters) {
  SolidScene scene = two_blocks(0.01);
  const auto refuse = [&](const std::string& parameter, const char* value) {
    scene.effects = {{"self_contact", {{parameter, value}}}};
    expect_refusal([&] { make_solid_world(scene); }, {parameter});
  };
  for (const char* bad : {"0", "-1", "nan", "2"}) refuse("thickness", bad);
  for (const char* bad : {"-1", "nan", "2"}) refuse("margin", bad);
  for (const char* bad : {"-0.1", "nan", "inf"}) refuse("friction", bad);
}

TEST(SelfContactOfACloth, IsRefusedWhereItFellIntoAHeap) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 21, 21};
  scene.solver = "lbfgs";
  scene.effects = {{"self_contact", {{"thickness", "0.002"}}}};
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  // All within a thickness: some 350,000 vertices and triangles are near each other.
  Particles& p = particles_of(*world);
  p.x *= 1e-3 / 0.3;
  const Positions before = p.x;
  EXPECT_FALSE(world->step());
  EXPECT_EQ(p.x, before);
  // No more of them were made than tell that there are too many.
  EXPECT_EQ(effect_of<SelfContactEffect>(*world, "self_contact").contacts().size(), 44101u);
  const std::string& failure = body_of(*world).report.failure;
  for (const char* part : {"body 'cloth'", "more than 44100 pairs", "fell into a heap", "undone"}) {
    EXPECT_NE(failure.find(part), std::string::npos) << failure;
  }
}

}  // namespace
}  // namespace pliant::self_contact_test
