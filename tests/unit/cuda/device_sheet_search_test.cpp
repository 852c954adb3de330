// The CUDA backend's search of a sheet's contacts with itself, its kernels run by the CPU, against
// the CPU's own: the same contacts, in the same order and to the bit.
#include "cuda/effects/device_sheet_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "cuda/core/host_executor.h"
#include "pliant/effects/self_contact/self_contact.h"
#include "pliant/effects/self_contact/sheet_contact_detection.h"
#include "support/meshes/intersections.h"
#include "support/solvers/failing_executor.h"
#include "support/solvers/sheet_searches.h"
#include "support/worlds/crumpling_sheet.h"

namespace pliant {
namespace {

using HostSearch = DeviceSheetSearch<HostExecutor>;

SheetComparison compared(const MovingSheet& sheet) {
  SheetTreeSearch cpu = search_of(sheet);
  HostSearch device(cpu);
  return compare(sheet, device, cpu);
}

TEST(DeviceSheetSearch, FindsWhatTheCpuFindsInAFold) {
  const SheetComparison seen = compared(folded_sheet(17, 0.006));
  EXPECT_GT(seen.near_pairs, 1000u);
  EXPECT_GT(seen.held_back, 0);
}

class DeviceSheetSearchOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, DeviceSheetSearchOf, testing::Range(1, 4));

TEST_P(DeviceSheetSearchOf, ACrumpledSheetFindsWhatTheCpuFinds) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  const SheetComparison seen = compared(crumpled_sheet(6 + GetParam(), seed));
  EXPECT_GT(seen.near_pairs, 1000u);
  EXPECT_GT(seen.held_back, 0);
}

TEST_P(DeviceSheetSearchOf, TrianglesInNoOrderFindsWhatTheCpuFinds) {
  const SheetComparison seen = compared(triangle_soup(60, static_cast<std::uint64_t>(GetParam())));
  EXPECT_GT(seen.near_pairs, 300u);
}

TEST(DeviceSheetSearch, FindsWhatTheCpuFindsInLayersThatCoincide) {
  EXPECT_GT(compared(coincident_layers(9)).near_pairs, 100u);
}

TEST(DeviceSheetSearch, StopsWhatGoesThroughATriangleAtFiveMetresASecond) {
  const SheetComparison seen = compared(shot_sheet());
  EXPECT_GT(seen.near_pairs, 10u);
  EXPECT_EQ(seen.held_back, 3) << "all parts of the path";
}

TEST(DeviceSheetSearch, GrowsWithWhatItFinds) {
  // From far apart to all in one place: pairs are none, then most that there can be.
  MovingSheet sheet = folded_sheet(7, 0.1, 0.0, 3);
  sheet.steps[2].end = 0.01 * sheet.steps[2].end;
  SheetTreeSearch cpu = search_of(sheet);
  HostSearch device(cpu);
  compare({sheet.rest, {sheet.steps[0]}}, device, cpu);
  const int first = device.cost().candidates;
  compare({sheet.rest, {sheet.steps[2]}}, device, cpu);
  EXPECT_GT(device.cost().candidates, 10 * first);
  compare({sheet.rest, {sheet.steps[0]}}, device, cpu);
  EXPECT_LE(device.cost().candidates, 2 * first);
}

TEST(DeviceSheetSearch, CandidatesServeManySteps) {
  const MovingSheet sheet = folded_sheet(17, 0.006, 0.05, 12);
  SheetTreeSearch cpu = search_of(sheet);
  HostSearch device(cpu);
  device.find(sheet.steps[0].start, sheet.steps[0].end);
  int least = device.cost().awake;
  for (const SheetMotion& step : sheet.steps) {
    device.find(step.start, step.end);
    least = std::min(least, device.cost().awake);
  }
  EXPECT_LE(device.cost().collections, 4);
  EXPECT_LT(least, device.cost().candidates / 4);
}

TEST(DeviceSheetSearch, WhatIsNotFiniteMeetsNothingAndIsForgotten) {
  MovingSheet sheet = folded_sheet(7, 0.004, 0.1, 4);
  sheet.steps[1].end(1, 20) = std::numeric_limits<double>::quiet_NaN();
  sheet.steps[2].end(0, 3) = std::numeric_limits<double>::infinity();
  SheetTreeSearch cpu = search_of(sheet);
  HostSearch device(cpu);
  for (const SheetMotion& step : sheet.steps) {
    const SheetNearPairs exact = cpu.find(step.start, step.end);
    const SheetNearPairs found = device.find(step.start, step.end);
    expect_same(found, exact);
    EXPECT_EQ(exact.empty(), !step.end.allFinite());
  }
}

TEST(DeviceSheetSearch, TakesASheetOfNothing) {
  const SheetTreeSearch cpu(Positions(3, 0), Eigen::Matrix3Xi(3, 0), 0.004, 0.001);
  HostSearch device(cpu);
  EXPECT_TRUE(device.find(Positions(3, 0), Positions(3, 0)).empty());
}

class FailingSheetSearch : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Launches, FailingSheetSearch, testing::Values(1, 30, 45, 60, 80));

TEST_P(FailingSheetSearch, IsToldOnceAndTheCpuGoesOn) {
  const MovingSheet sheet = shot_sheet();
  const PairDetection::Options options = {sheet.thickness, sheet.margin, 0.5};
  SheetContactDetection exact(sheet.rest.vertices, sheet.rest.triangles, options);
  SheetContactDetection device(sheet.rest.vertices, sheet.rest.triangles, options);
  FailingExecutor::left = 1 << 30;
  device.set_device(std::make_unique<DeviceSheetSearch<FailingExecutor>>(device.search_on_cpu()));
  FailingExecutor::left = GetParam();
  Particles particles(sheet.rest.vertices, Eigen::VectorXd::Ones(sheet.rest.vertices.cols()));
  particles.x_start = sheet.steps[0].start;
  particles.x = sheet.steps[0].end;
  std::vector<PairContact> found, wanted;
  const auto expect_same_contacts = [&] {
    ASSERT_EQ(found.size(), wanted.size());
    EXPECT_GT(found.size(), 0u);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].normal, wanted[k].normal);
      EXPECT_EQ(found[k].least, wanted[k].least);
      EXPECT_EQ(found[k].start, wanted[k].start);
    }
  };
  exact.find(particles, 0.005, wanted);
  device.find(particles, 0.005, found);
  expect_same_contacts();
  Positions x = particles.x, y = particles.x;
  EXPECT_FALSE(exact.limit_displacement(particles, 0.005, x, wanted));
  EXPECT_FALSE(device.limit_displacement(particles, 0.005, y, found));
  EXPECT_EQ(x, y);
  expect_same_contacts();
  EXPECT_FALSE(device.has_device());
  EXPECT_EQ(device.take_device_failure(), "out of memory");
  EXPECT_EQ(device.take_device_failure(), "");
}

TEST(DeviceSheetSearchScene, AFallingSheetGoesTheWayThatTheCpusSearchGives) {
  std::vector<Positions> ends;
  for (const bool on_device : {false, true}) {
    const auto world = make_world(crumpling_sheet());
    Body& body = body_of(*world);
    auto& effect = dynamic_cast<SelfContactEffect&>(*body.find_effect("self_contact"));
    auto& detection = dynamic_cast<SheetContactDetection&>(effect.detection());
    if (on_device) {
      detection.set_device(std::make_unique<HostSearch>(detection.search_on_cpu()));
    }
    for (int step = 0; step < 50; ++step) ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_EQ(detection.has_device(), on_device);
    EXPECT_GT(effect.contacts().size(), 20u);
    EXPECT_EQ(count_intersections(body.particles().x, body.model->surface_triangles()), 0);
    ends.push_back(body.particles().x);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(DeviceSheetSearchScene, AFailureIsToldInTheReportAndTheWayIsTheCpus) {
  const auto world = make_world(crumpling_sheet()), exact = make_world(crumpling_sheet());
  Body& body = body_of(*world);
  auto& effect = dynamic_cast<SelfContactEffect&>(*body.find_effect("self_contact"));
  auto& detection = dynamic_cast<SheetContactDetection&>(effect.detection());
  FailingExecutor::left = 1 << 30;
  detection.set_device(
      std::make_unique<DeviceSheetSearch<FailingExecutor>>(detection.search_on_cpu()));
  FailingExecutor::left = 1;
  int told = 0;
  for (int step = 0; step < 5; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_TRUE(exact->step()) << exact->failure();
    EXPECT_EQ(body.particles().x, particles_of(*exact).x) << step;
    for (const std::string& warning : body.report.warnings) {
      if (warning.find("self_contact_cpu") == std::string::npos) continue;
      EXPECT_NE(warning.find("out of memory"), std::string::npos) << warning;
      ++told;
    }
  }
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(detection.has_device());
}

}  // namespace
}  // namespace pliant
