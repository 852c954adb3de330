#include "pliant/solvers/components/rigid_modes.h"

#include <gtest/gtest.h>

#include <memory>

#include "pliant/elements/attachment_set.h"
#include "support/random.h"
#include "support/solvers/system_model.h"

namespace pliant::rigid_modes_test {
namespace {

constexpr double kStep = 0.01;  // [s]

Components components_of(SystemModel& model) {
  return find_components(static_cast<const ProjectiveSystem&>(model.system()));
}

/// Two triangles of springs, 0 1 2 and 3 4 5, and a particle alone.
std::unique_ptr<SystemModel> two_triangles() {
  Random random(7);
  auto model = std::make_unique<SystemModel>(random.positions(7, 1.0));
  model->add("stretch", {{0, 1, 1.0, 10.0}, {1, 2, 1.0, 10.0}, {2, 0, 1.0, 10.0}});
  model->add("more", {{3, 4, 1.0, 20.0}, {4, 5, 1.0, 20.0}, {5, 3, 1.0, 20.0}});
  return model;
}

RigidModes modes_of(SystemModel& model) {
  RigidModes modes;
  modes.prepare(components_of(model), model.particles().mass / (kStep * kStep));
  modes.update(model.particles().x);
  return modes;
}

TEST(Components, AreWhatElementsHoldTogether) {
  const auto model = two_triangles();
  const Components found = components_of(*model);
  EXPECT_EQ(found.of, (std::vector<int>{0, 0, 0, 1, 1, 1, 2}));
  EXPECT_EQ(found.begins, (std::vector<int>{0, 3, 6, 7}));
  EXPECT_EQ(found.held, (std::vector<bool>{false, false, false}));
}

TEST(Components, AreHeldByPinnedParticlesAndAttachments) {
  const auto model = two_triangles();
  model->particles().fix(1);
  auto attachments = std::make_unique<AttachmentSet>(7);
  attachments->add(4, Eigen::Vector3d::Zero(), 300.0);
  model->add(std::move(attachments));
  const Components found = components_of(*model);
  EXPECT_EQ(found.of[1], Components::kNone);
  EXPECT_EQ(found.held, (std::vector<bool>{true, true, false}));
  EXPECT_EQ(modes_of(*model).count(), 1);
}

// What B makes of forces holds exactly their momentum and their moment, whatever G is.
TEST(RigidModes, DisplacementsHoldTheMomentumOfTheForces) {
  const auto model = two_triangles();
  RigidModes modes = modes_of(*model);
  Random random(3);
  const Forces f = random.positions(7, 1.0);
  Eigen::Matrix3Xd d = f;
  modes.take_out(d);
  for (int i = 0; i < d.cols(); ++i) d.col(i) *= 1e-4 * (1.0 + i);  // G
  modes.put_in(d);
  const Particles& p = model->particles();
  for (const auto& [first, last] : {std::make_pair(0, 3), std::make_pair(3, 6)}) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = force, momentum = force, spin = force;
    for (int i = first; i < last; ++i) {
      const Eigen::Vector3d x = p.x.col(i), push = f.col(i);
      const Eigen::Vector3d gain = p.mass[i] / (kStep * kStep) * d.col(i);
      force += push;
      torque += x.cross(push);
      momentum += gain;
      spin += x.cross(gain);
    }
    EXPECT_LE((momentum - force).norm(), 1e-12 * f.norm());
    EXPECT_LE((spin - torque).norm(), 1e-12 * f.norm());
  }
}

TEST(RigidModes, AreTakenOutOnce) {
  const auto model = two_triangles();
  RigidModes modes = modes_of(*model);
  Forces f = Random(5).positions(7, 1.0);
  modes.take_out(f);
  const Forces once = f;
  modes.take_out(f);
  EXPECT_LE((f - once).norm(), 1e-12);
}

}  // namespace
}  // namespace pliant::rigid_modes_test
