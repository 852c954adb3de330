#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/error.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/markers/color_by.h"
#include "pliant/ros/markers/contact_messages.h"
#include "pliant/ros/markers/mark_messages.h"
#include "pliant/ros/markers/mesh_messages.h"
#include "pliant/ros/markers/obstacle_marker.h"
#include "pliant/ros/markers/points_message.h"
#include "pliant/ros/markers/shading.h"
#include "pliant/ros/markers/shadow_marker.h"
#include "pliant/ros/markers/surface_marker.h"
#include "pliant/ros/notices.h"
#include "pliant/ros/running/snapshot.h"
#include "pliant/ros/running/step_statistics.h"
#include "pliant/scene/scene.h"

namespace pliant {
namespace {

using visualization_msgs::Marker;

LoadedScene hanging() { return load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/hanging.yaml"); }

Snapshot snapshot_of(World& world, unsigned contents) {
  Snapshot snapshot(world);
  for (BodySnapshot& body : snapshot.bodies) body.contents = contents;
  snapshot.contents = contents;
  snapshot.header.frame_id = "world";
  snapshot.take(world);
  return snapshot;
}

TEST(StepStatistics, MeansAndMaxima) {
  std::deque<Body> bodies(1);
  bodies[0].report.phases = {{"gravity", 1.0}};
  bodies[0].report.warnings = {"slow"};
  StepStatistics statistics(1);
  EXPECT_EQ(statistics.mean_time(), 0.0);
  statistics.add(bodies, 0.1, 1.0);
  statistics.add(bodies, 0.1, 3.0);
  EXPECT_EQ(statistics.mean_time(), 2.0);
  EXPECT_EQ(statistics.max_time(), 3.0);
  ASSERT_EQ(statistics.phases().size(), 1u);
  EXPECT_EQ(statistics.phases()[0].seconds, 2.0);
  EXPECT_EQ(statistics.warnings().size(), 1u);
  EXPECT_GT(statistics.real_time_factor(), 0.0);
  statistics.clear();
  EXPECT_EQ(statistics.steps(), 0u);
  EXPECT_TRUE(statistics.warnings().empty());
}

TEST(PointsMessage, HoldsPositionsVelocitiesAndFields) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  for (int s = 0; s < 10; ++s) world.step();
  const Particles& particles = world.bodies().front().particles();
  VertexColors colors(world.bodies().front(), VertexColors::Of::kParticles);
  PointsMessage message;
  const Snapshot snapshot = snapshot_of(world, Snapshot::kPoints);
  const sensor_msgs::PointCloud2& cloud =
      message.update(snapshot.bodies.front(), snapshot.header, colors.update({}));
  ASSERT_EQ(cloud.width, 132u);
  ASSERT_EQ(cloud.data.size(), cloud.width * cloud.point_step);
  ASSERT_GE(cloud.fields.size(), 7u);
  std::vector<float> point(cloud.fields.size());
  std::memcpy(point.data(), cloud.data.data() + 5 * cloud.point_step, cloud.point_step);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(point[static_cast<std::size_t>(axis)], static_cast<float>(particles.x(axis, 5)));
    EXPECT_EQ(point[static_cast<std::size_t>(axis + 4)], static_cast<float>(particles.v(axis, 5)));
  }
  std::uint32_t rgb = 0;
  std::memcpy(&rgb, &point[3], sizeof rgb);
  const Eigen::Vector3f color = world.bodies().front().model->color;
  EXPECT_EQ(rgb >> 16, static_cast<std::uint32_t>(std::round(255.0f * color.x())));
}

TEST(PointsMessage, IsReadByTheIteratorsOfSensorMsgs) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  VertexColors colors(world.bodies().front(), VertexColors::Of::kParticles);
  Snapshot snapshot = snapshot_of(world, Snapshot::kPoints);
  snapshot.bodies[0].fields["zeal"] = Eigen::VectorXd::LinSpaced(132, 0.0, 131.0);
  PointsMessage message;
  sensor_msgs::PointCloud2 cloud =
      message.update(snapshot.bodies[0], snapshot.header, colors.update({}));
  sensor_msgs::PointCloud2Iterator<float> zeal(cloud, "zeal"), stretch(cloud, "stretch");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> red(cloud, "r");
  EXPECT_EQ(*(zeal + 7), 7.0f);
  EXPECT_EQ(*(stretch + 7), static_cast<float>(snapshot.bodies[0].fields["stretch"][7]));
  EXPECT_EQ(*red, std::lround(255.0f * world.bodies().front().model->color.x()));
  // Fewer points and fields later: the message follows.
  snapshot.bodies[0].x.conservativeResize(3, 5);
  snapshot.bodies[0].fields = {{"zeal", Eigen::VectorXd::Ones(5)}};
  cloud = message.update(snapshot.bodies[0], snapshot.header, colors.update({}));
  EXPECT_EQ(cloud.width, 5u);
  EXPECT_EQ(cloud.fields.size(), 8u);
  EXPECT_EQ(cloud.data.size(), 5u * 8u * sizeof(float));
}

TEST(MeshMessages, SaysTrianglesOnceAndTwelveBytesAPoint) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  const Body& body = world.bodies().front();
  MeshMessages mesh(body, "cloth");
  EXPECT_EQ(mesh.topology().body, "cloth");
  EXPECT_EQ(mesh.topology().vertices, 132u);
  const Eigen::Matrix3Xi& triangles = body.model->surface_triangles();
  ASSERT_EQ(mesh.topology().triangles.size(), static_cast<std::size_t>(triangles.size()));
  EXPECT_EQ(mesh.topology().triangles[4], static_cast<std::uint32_t>(triangles(1, 1)));
  const std::uint32_t version = mesh.topology().version;
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(world.step());
    const Snapshot snapshot = snapshot_of(world, Snapshot::kMesh);
    EXPECT_FALSE(mesh.update(snapshot.bodies[0], snapshot.header)) << "the same triangles";
    EXPECT_EQ(mesh.points().version, version);
  }
  EXPECT_EQ(mesh.points().xyz[3 * 7 + 2], static_cast<float>(body.particles().x(2, 7)));
  EXPECT_LE(ros::serialization::serializationLength(mesh.points()), 132u * 15u);
}

TEST(MeshMessages, NewTrianglesHaveANewVersion) {
  LoadedScene scene = hanging();
  MeshMessages mesh(scene.world->bodies().front(), "cloth");
  const std::uint32_t first = mesh.topology().version;
  BodySnapshot snapshot;
  snapshot.surface_changes = true;
  snapshot.surface = Eigen::Matrix3Xd::Identity(3, 3);
  snapshot.surface_triangles.resize(3, 1);
  snapshot.surface_triangles << 0, 1, 2;
  EXPECT_TRUE(mesh.update(snapshot, {}));
  EXPECT_EQ(mesh.topology().version, first + 1);
  EXPECT_EQ(mesh.points().version, first + 1);
  EXPECT_FALSE(mesh.update(snapshot, {})) << "the same again";
  snapshot.surface_triangles << 0, 2, 1;
  EXPECT_TRUE(mesh.update(snapshot, {}));
  snapshot.surface = Eigen::Matrix3Xd::Zero(3, 4);
  EXPECT_TRUE(mesh.update(snapshot, {})) << "another number of points";
  EXPECT_EQ(mesh.topology().vertices, 4u);
  EXPECT_EQ(mesh.topology().version, first + 3);
}

TEST(ContactMessages, NameWhatTouchesWhat) {
  LoadedScene scene = load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/pressed.yaml");
  const World& world = *scene.world;
  ContactMessages messages(world, BodyNames(world.bodies()));
  std::vector<TouchedPoint> touched(3);
  for (TouchedPoint& touch : touched) {
    touch.point = {1.0, 2.0, 3.0};
    touch.normal = Eigen::Vector3d::UnitZ();
    touch.force = {0.0, 0.0, 5.0};
  }
  const auto finger = std::find_if(world.obstacles().begin(), world.obstacles().end(),
                                   [](const Obstacle& o) { return o.link == "left_finger"; });
  touched[0].obstacle = 0;
  touched[1].obstacle = static_cast<int>(finger - world.obstacles().begin());
  touched[2].body = 1;
  touched[2].other_body = 0;
  touched[2].vertex = 7;
  const Contacts& message = messages.update(touched, 12);
  EXPECT_EQ(message.step, 12u);
  EXPECT_EQ(message.bodies, (std::vector<std::string>{"towel", "towel", "soft-ball"}));
  EXPECT_EQ(message.others, (std::vector<std::string>{"table", "left_finger", "towel"}));
  EXPECT_EQ(message.kinds,
            (std::vector<std::uint8_t>{Contacts::OBSTACLE, Contacts::LINK, Contacts::BODY}));
  EXPECT_EQ(message.vertices[2], 7);
  EXPECT_EQ(message.points[1].y, 2.0);
  EXPECT_EQ(message.forces[1].z, 5.0);
  EXPECT_EQ(messages.update({}, 13).points.size(), 0u) << "nothing is left of the last one";
}

TEST(Snapshot, TakesNothingUnasked) {
  LoadedScene scene = load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/lying.yaml");
  World& world = *scene.world;
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step());
  const Snapshot nothing = snapshot_of(world, 0);
  EXPECT_TRUE(nothing.touched.empty());
  EXPECT_EQ(nothing.bodies[0].surface.cols(), 0);
  EXPECT_EQ(nothing.bodies[0].x.cols(), 0);
  EXPECT_FALSE(snapshot_of(world, Snapshot::kContacts).touched.empty());
  EXPECT_EQ(snapshot_of(world, Snapshot::kContacts).bodies[0].surface.cols(), 0);
  EXPECT_EQ(snapshot_of(world, Snapshot::kMesh).bodies[0].surface.cols(), 64);
}

TEST(Notices, AreNewOnceAndEnd) {
  Notices notices;
  EXPECT_TRUE(notices.set("clock", "two"));
  EXPECT_FALSE(notices.set("clock", "two"));
  EXPECT_TRUE(notices.set("clock", "three"));
  EXPECT_TRUE(notices.set("master", "gone"));
  EXPECT_EQ(notices.all(), (std::vector<std::string>{"three", "gone"}));
  EXPECT_TRUE(notices.clear("clock"));
  EXPECT_FALSE(notices.clear("clock"));
  EXPECT_EQ(notices.all(), (std::vector<std::string>{"gone"}));
}

TEST(SurfaceMarker, HasTheTrianglesOfTheModel) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  SurfaceMarker surface(world.bodies().front());
  const Snapshot snapshot = snapshot_of(world, Snapshot::kSurface);
  Marker marker = surface.first("world", "surface");
  surface.update(snapshot.bodies.front(), snapshot.header, marker);
  const Eigen::Matrix3Xi& triangles = world.bodies().front().model->surface_triangles();
  ASSERT_EQ(marker.points.size(), static_cast<std::size_t>(triangles.size()));
  EXPECT_EQ(to_vector(marker.points[4]), world.bodies().front().particles().x.col(triangles(1, 1)));
  EXPECT_EQ(marker.colors.size(), marker.points.size());
}

TEST(VertexColors, WetIsDarker) {
  LoadedScene scene = hanging();
  VertexColors colors(scene.world->bodies().front(), VertexColors::Of::kParticles);
  Eigen::VectorXd wetness = Eigen::VectorXd::Zero(132);
  wetness[1] = 1.0;
  wetness[2] = 7.0;
  const Eigen::Matrix3Xf result = colors.update(wetness);
  EXPECT_LT(result(2, 1), result(2, 0));
  EXPECT_EQ(result(2, 2), result(2, 1)) << "clamped";
}

TEST(MarkMessages, SendsWhatChangedAndDeletesWhatEnded) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  MarkMessages marks(world, true);
  Snapshot snapshot = snapshot_of(world, Snapshot::kMarkers);
  EXPECT_EQ(marks.update(snapshot, false).markers.size(), 3u) << "two obstacles, fixed vertices";
  EXPECT_EQ(marks.update(snapshot, false).markers.size(), 1u);
  EXPECT_EQ(marks.update(snapshot, true).markers.size(), 3u);
  snapshot.forces.push_back({Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, 1e300)});
  const auto with_force = marks.update(snapshot, false).markers;
  ASSERT_EQ(with_force.size(), 2u);
  EXPECT_EQ(with_force[0].type, Marker::ARROW);
  EXPECT_LT(with_force[0].points[1].z, 1.0) << "stays in the picture";
  snapshot.forces.clear();
  EXPECT_EQ(marks.update(snapshot, false).markers[0].action, Marker::DELETE);
  EXPECT_EQ(marks.update(snapshot, false).markers.size(), 1u) << "deleted once";
  snapshot.obstacle_poses[0].translation().x() += 0.1;
  EXPECT_EQ(marks.update(snapshot, false).markers[0].id, 0);
}

/// z of its highest point, in its frame.
double highest(const Marker& marker) {
  double z = -1e9;
  for (const auto& point : marker.points) z = std::max(z, point.z);
  return z;
}

TEST(ObstacleMarker, ShowsEveryShape) {
  const auto marker_of = [](std::shared_ptr<const Shape> shape) {
    Obstacle obstacle;
    obstacle.shape = std::move(shape);
    return obstacle_marker(obstacle, Eigen::Isometry3d::Identity());
  };
  const Marker plane = marker_of(std::make_shared<Plane>());
  EXPECT_EQ(plane.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(highest(plane), 0.0) << "its upper face is the plane";
  EXPECT_EQ(marker_of(std::make_shared<Sphere>(0.1)).type, Marker::SPHERE);
  EXPECT_EQ(highest(marker_of(std::make_shared<Box>(Eigen::Vector3d(1, 2, 3)))), 1.5);
  EXPECT_EQ(marker_of(std::make_shared<Cylinder>(0.1, 0.5)).scale.z, 0.5);
  const Marker capsule = marker_of(std::make_shared<Capsule>(0.1, 0.5));
  EXPECT_EQ(capsule.type, Marker::TRIANGLE_LIST);
  EXPECT_GT(capsule.points.size(), 30u);
}

/// Brightness of each face of a white box: by the z of its normal in the box's frame.
std::map<int, float> brightness_of_faces(const Eigen::Isometry3d& pose) {
  Obstacle obstacle;
  obstacle.shape = std::make_shared<Box>(Eigen::Vector3d(1, 1, 1));
  obstacle.color = Eigen::Vector4f(1.0f, 1.0f, 1.0f, 0.5f);
  const Marker marker = obstacle_marker(obstacle, pose);
  EXPECT_EQ(marker.points.size(), 36u);
  EXPECT_EQ(marker.colors.size(), 36u);
  std::map<int, float> brightness;
  for (std::size_t k = 0; k < marker.points.size(); k += 3) {
    const auto z = marker.points[k].z + marker.points[k + 1].z + marker.points[k + 2].z;
    brightness[static_cast<int>(std::round(2.0 * z))] = marker.colors[k].r;
    EXPECT_EQ(marker.colors[k].a, 0.5f);
  }
  return brightness;
}

TEST(ObstacleMarker, ABoxIsBrightFromAboveHoweverItIsTurned) {
  const auto level = brightness_of_faces(Eigen::Isometry3d::Identity());
  EXPECT_GT(level.at(3), 0.9f) << "the upper face";
  EXPECT_LT(level.at(-3), 0.5f) << "the lower face";
  const auto turned =
      brightness_of_faces(Eigen::Isometry3d(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())));
  EXPECT_LT(turned.at(3), 0.5f);
  EXPECT_GT(turned.at(-3), 0.9f);
}

/// A world of one small cloth far below, and these obstacles.
class Shadows : public testing::Test {
 protected:
  void add(std::shared_ptr<const Shape> shape, const Eigen::Isometry3d& pose) {
    Obstacle obstacle;
    obstacle.shape = std::move(shape);
    obstacle.pose_start = obstacle.pose_end = pose;
    obstacles_.push_back(obstacle);
  }
  Marker cast() {
    LoadedScene scene = hanging();
    scene.world->obstacles() = obstacles_;
    Snapshot snapshot(*scene.world);
    snapshot.contents = Snapshot::kShadows;
    snapshot.take(*scene.world);
    snapshot.bodies.front().surface.row(2).setConstant(-9.0);
    return ShadowMarker(*scene.world).update(snapshot);
  }
  static Eigen::AlignedBox3d box_of(const Marker& marker) {
    Eigen::AlignedBox3d box;
    for (const auto& point : marker.points) box.extend(to_vector(point));
    return box;
  }
  static Eigen::Isometry3d at(double x, double y, double z) {
    return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
  }
  const std::shared_ptr<const Shape> table_ = std::make_shared<Box>(Eigen::Vector3d(1, 1, 0.1));
  const std::shared_ptr<const Shape> ball_ = std::make_shared<Sphere>(0.1);
  std::vector<Obstacle> obstacles_;
};

TEST_F(Shadows, FallAwayFromTheLightOnTheTable) {
  add(table_, at(0, 0, -0.05));
  add(ball_, at(0, 0, 0.3));
  const Marker shadow = cast();
  ASSERT_GT(shadow.points.size(), 30u);
  EXPECT_EQ(shadow.colors.size(), shadow.points.size());
  const Eigen::AlignedBox3d box = box_of(shadow);
  const Eigen::Vector3d center = -0.3 / to_light().z() * to_light();
  EXPECT_NEAR(box.center().x(), center.x(), 0.01);
  EXPECT_NEAR(box.center().y(), center.y(), 0.01);
  EXPECT_GT(box.min().z(), 0.0);
  EXPECT_LT(box.max().z(), 1e-3);
}

TEST_F(Shadows, EndAtTheEdgeOfTheTable) {
  add(table_, at(0, 0, -0.05));
  add(ball_, at(-0.4, 0, 0.2));
  const Eigen::AlignedBox3d box = box_of(cast());
  EXPECT_NEAR(box.min().x(), -0.5, 1e-9);
  obstacles_[1].pose_end = at(-2, 0, 0.2);
  EXPECT_TRUE(cast().points.empty()) << "beside the table";
}

TEST_F(Shadows, FallOnTheHighestTableBelowAndOnNothingThatSlopes) {
  add(std::make_shared<Plane>(), at(0, 0, -0.5));
  add(ball_, at(0, 0, 0.3));
  const Eigen::AlignedBox3d on_plane = box_of(cast());
  EXPECT_NEAR(on_plane.max().z(), -0.5, 1e-3);
  add(table_, at(0, 0, -0.05));
  EXPECT_NEAR(box_of(cast()).max().z(), 0.0, 1e-3);
  obstacles_ = {obstacles_[1], obstacles_[2]};
  obstacles_[1].pose_end.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(cast().points.empty());
}

TEST(ColorScale, FollowsWhatOccursInRoundNumbersAndNeverNarrows) {
  ColorScale scale(0.0, 0.0);
  EXPECT_FALSE(scale.follow({0.0, 0.0, 0.0}, 0.0)) << "alike all over: no range yet";
  EXPECT_TRUE(scale.follow({0.0, 0.01, 0.13}, 1.0));
  EXPECT_EQ(scale.min(), 0.0);
  EXPECT_NEAR(scale.max(), 0.16, 1e-12) << "steps of a fifth of 0.2";
  EXPECT_FALSE(scale.follow({0.0, 0.01, 0.15}, 2.0));
  EXPECT_TRUE(scale.follow({-0.1, 0.0, NAN}, 3.0));
  EXPECT_FALSE(scale.follow({NAN}, 4.0));
  EXPECT_NEAR(scale.min(), -0.1, 1e-12);
  EXPECT_NEAR(scale.max(), 0.2, 1e-12) << "steps of a fifth of 0.5";
  ColorScale given(1.0, 2.0);
  EXPECT_FALSE(given.follow({0.0, 3.0, 5.0}, 0.0));
  EXPECT_EQ(given.max(), 2.0);
}

/// 100 values from 0 to 0.99 `most`, the last three of them peaks.
std::vector<double> with_peaks(double most, double peak) {
  std::vector<double> values(100);
  for (int i = 0; i < 100; ++i) values[static_cast<std::size_t>(i)] = 0.01 * i * most;
  values[97] = values[98] = values[99] = peak;
  return values;
}

TEST(ColorScale, LeavesPeaksOutWhereItHasATail) {
  ColorScale scale(0.0, 0.0, 0.05);
  EXPECT_TRUE(scale.follow(with_peaks(1.0, 50.0), 0.0));
  EXPECT_NEAR(scale.min(), 0.0, 1e-12);
  EXPECT_NEAR(scale.max(), 1.0, 1e-12);
  // Most values have colours of their own, which with the peaks they have not.
  ColorScale all(0.0, 0.0);
  all.follow(with_peaks(1.0, 50.0), 0.0);
  const Eigen::Vector2d two(0.2, 0.8);
  EXPECT_GT((scale.colors(two).col(1) - scale.colors(two).col(0)).norm(), 0.5f);
  EXPECT_LT((all.colors(two).col(1) - all.colors(two).col(0)).norm(), 0.05f);
}

TEST(ColorScale, ATailFollowsSlowlyAndNarrowsMoreSlowlyStill) {
  ColorScale scale(0.0, 0.0, 0.05);
  scale.follow(with_peaks(1.0, 5.0), 0.0);
  scale.follow(with_peaks(10.0, 50.0), 0.01);
  EXPECT_LE(scale.max(), 2.0) << "a picture alone changes little";
  for (int k = 2; k <= 150; ++k) scale.follow(with_peaks(10.0, 50.0), 0.01 * k);
  EXPECT_NEAR(scale.max(), 10.0, 1e-12);
  for (int k = 151; k <= 250; ++k) scale.follow(with_peaks(1.0, 5.0), 0.01 * k);
  EXPECT_NEAR(scale.max(), 10.0, 1e-12);
  int changes = 0;
  for (int k = 251; k <= 2000; ++k) changes += scale.follow(with_peaks(1.0, 5.0), 0.01 * k);
  EXPECT_LE(scale.max(), 2.0);
  EXPECT_LE(changes, 4) << "in round numbers";
  // A scene that was reset begins anew.
  EXPECT_TRUE(scale.follow(with_peaks(10.0, 50.0), 0.0));
  EXPECT_NEAR(scale.max(), 10.0, 1e-12);
}

TEST(ColorScale, ShowsTheFewThatDifferWhereNearlyAllIsAlike) {
  ColorScale scale(0.0, 0.0, 0.05);
  std::vector<double> warm(100, 293.0);
  warm[3] = 393.0;
  EXPECT_TRUE(scale.follow(warm, 0.0));
  EXPECT_GE(scale.max(), 393.0);
}

TEST(ColorScale, IsBlueThenYellowAndOnlyGrowsBrighter) {
  const ColorScale scale(0.0, 1.0);
  const Eigen::Matrix3Xf colors = scale.colors(Eigen::VectorXd::LinSpaced(101, 0.0, 1.0));
  EXPECT_GT(colors(2, 0), 2.0f * colors(0, 0));
  EXPECT_GT(colors(0, 100), 2.0f * colors(2, 100));
  const Eigen::RowVectorXf luminance = Eigen::RowVector3f(0.21f, 0.72f, 0.07f) * colors;
  for (Eigen::Index i = 1; i < luminance.size(); ++i) EXPECT_GT(luminance[i], luminance[i - 1]);
  const Eigen::Matrix3Xf beyond = scale.colors(Eigen::Vector3d(-5.0, 7.0, NAN));
  EXPECT_EQ(beyond.col(0), colors.col(0));
  EXPECT_EQ(beyond.col(1), colors.col(100));
  EXPECT_EQ(beyond.col(2), Eigen::Vector3f::Ones());
}

TEST(ColorBy, FindsEachBodysFieldAndRefusesWhatNoneHas) {
  LoadedScene scene = load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/together.yaml");
  const auto& bodies = scene.world->bodies();
  const std::vector<std::string> strain = fields_to_color(bodies, "strain");
  ASSERT_EQ(strain.size(), bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto model = bodies[b].model->name();
    EXPECT_EQ(strain[b], model == "cloth" ? "stretch" : model == "patch" ? "strain" : "") << model;
  }
  EXPECT_EQ(fields_to_color(bodies, "none"), std::vector<std::string>(bodies.size()));
  EXPECT_EQ(fields_to_color(bodies, "speed")[0], "speed");
  try {
    fields_to_color(bodies, "strian");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("~color_by"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("did you mean 'strain'"), std::string::npos);
  }
}

TEST(ColorBy, SurfaceShowsTheSpeedOfItsVertices) {
  LoadedScene scene = hanging();
  World& world = *scene.world;
  for (int s = 0; s < 10; ++s) world.step();
  Snapshot snapshot(world, fields_to_color(world.bodies(), "speed"));
  snapshot.contents = Snapshot::kSurfaces;
  snapshot.take(world);
  BodySnapshot& body = snapshot.bodies.front();
  const Eigen::VectorXd speeds = world.bodies().front().particles().v.colwise().norm().transpose();
  ASSERT_EQ(body.surface_values, speeds);
  ColorScale scale(0.0, speeds.maxCoeff());
  body.surface_colors = scale.colors(body.surface_values);
  SurfaceMarker surface(world.bodies().front());
  Marker marker = surface.first("world", "surface");
  surface.update(body, snapshot.header, marker);
  const Eigen::Matrix3Xi& triangles = world.bodies().front().model->surface_triangles();
  for (std::size_t k = 0; k < marker.colors.size(); ++k) {
    const int i = triangles.data()[k];
    // Shading changes the brightness, not the hue.
    EXPECT_NEAR(marker.colors[k].r * body.surface_colors(2, i),
                marker.colors[k].b * body.surface_colors(0, i), 1e-6);
  }
  const Marker legend = ColorLegend(world.bodies(), "speed").marker(snapshot.header, scale);
  EXPECT_NE(std::string(legend.text).find("m/s"), std::string::npos);
  EXPECT_GT(legend.pose.position.z, body.surface.row(2).maxCoeff());
}

TEST(Conversions, ThereAndBack) {
  Eigen::Isometry3d pose = Eigen::Translation3d(1.0, 2.0, 3.0) *
                           Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  const geometry_msgs::Pose message = to_pose(pose);
  geometry_msgs::Transform transform;
  transform.translation = to_vector3(to_vector(message.position));
  transform.rotation = message.orientation;
  EXPECT_TRUE(to_isometry(transform).isApprox(pose, 1e-12));
}

}  // namespace
}  // namespace pliant
