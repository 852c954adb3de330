#include "pliant/models/rigid/rigid.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/math/error.h"
#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {

// Of the cluster, per mass [1/s²]: gravity deforms the body by a micrometre in the course of a
// step, and after it not at all.
constexpr double kStiffness = 1e7;
// What a gripper presses a light body with has nothing to do with its weight: the least stiffness
// of any cluster [N/m], as far as equations that hold its inertia too keep their digits [1/s²].
constexpr double kLeastStiffness = 1e6, kMostStiffness = 1e9;

double stiffness_per_mass(double mass) {
  return std::clamp(kLeastStiffness / mass, kStiffness, kMostStiffness);
}

EmbeddedPoints embedded_in(const Eigen::Matrix3Xd& points, const Positions& corners) {
  Eigen::Matrix4d places;
  places << corners, Eigen::RowVector4d::Ones();
  Eigen::Matrix4Xd targets(4, points.cols());
  targets << points, Eigen::RowVectorXd::Ones(points.cols());
  const Eigen::Matrix4Xi particles = Eigen::Vector4i(0, 1, 2, 3).replicate(1, points.cols());
  return {particles, Eigen::Matrix4Xd(places.inverse() * targets)};
}

}  // namespace

RigidShape::Corners RigidShape::signs() {
  Corners signs;
  signs << 1, 1, -1, -1,  //
      1, -1, 1, -1,       //
      1, -1, -1, 1;
  return signs;
}

Eigen::Matrix3d RigidShape::axes(const Positions& x) const {
  const Corners from_center = x.colwise() - x.rowwise().mean();
  return nearest_rotation(from_center * (half.cwiseInverse().asDiagonal() * signs()).transpose())
      .toRotationMatrix();
}

void RigidSystem::keep_rigid(Positions& x) const {
  const Eigen::Vector3d center = x.rowwise().mean();
  x = shape.arms(shape.axes(x)).colwise() + center;
}

RigidModel::RigidModel(const BodyGeometry& geometry, const Material& material)
    : triangles_(geometry.mesh.triangles) {
  const VolumeMoments moments =
      geometry.moments ? *geometry.moments : volume_moments(geometry.mesh);
  if (!(moments.volume > 0.0)) {
    throw InputError("model 'rigid' needs a closed surface that encloses a volume");
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments.second / moments.volume);
  if (!(eigen.eigenvalues()[0] > 0.0)) {
    throw InputError("model 'rigid' needs a body with a thickness in all directions");
  }
  Eigen::Matrix3d axes = eigen.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  system_.shape.half = eigen.eigenvalues().cwiseSqrt();
  const double mass = material.mass > 0.0 ? material.mass : material.density * moments.volume;
  const Eigen::Vector3d squared = mass * eigen.eigenvalues();
  moments_ = Eigen::Vector3d::Constant(squared.sum()) - squared;
  const Positions corners = system_.shape.arms(axes).colwise() + moments.center;
  system_.particles = Particles(corners, Eigen::VectorXd::Constant(4, 0.25 * mass));
  Cluster cluster;
  cluster.particles = {0, 1, 2, 3};
  cluster.stiffness = stiffness_per_mass(mass);
  system_.elements.push_back(std::make_unique<ClusterSet>(
      corners, system_.particles.mass, std::vector<Cluster>{std::move(cluster)}));
  surface_ = embedded_in(geometry.mesh.vertices, corners);
  contact_ = embedded_in(geometry.contact_points, corners);
  bends_ = SurfaceBends(geometry.contact_normals, contact_, corners);
  cones_ = geometry.cones;
  axes_at_rest_ = axes;
  areas_ = Eigen::VectorXd::Constant(4, 0.25 * area(geometry.mesh));
}

std::string_view RigidModel::why_not_fix() const {
  return "a rigid body has no vertices to hold one by one: attach it to 'world', or make it an "
         "obstacle";
}

Eigen::Vector3d RigidModel::angular_momentum(const Particles& particles, const Positions& x,
                                             const Eigen::Matrix3Xd& v) {
  const Eigen::Vector3d center = x.rowwise().mean();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < particles.size(); ++i) {
    sum += particles.mass[i] * (x.col(i) - center).cross(v.col(i));
  }
  return sum;
}

void RigidModel::before_solver(Body&, const std::vector<Obstacle>&, double dt) {
  const Particles& p = particles();
  const Eigen::Vector3d center = p.x.rowwise().mean(), velocity = p.v.rowwise().mean();
  const Eigen::Matrix3d end = rotated_freely(axes(), moments_, angular_momentum(p, p.x, p.v), dt);
  // x + h v + h² f / m of the solver's prediction shall be the free motion.
  const RigidShape::Corners free = system_.shape.arms(end).colwise() + (center + dt * velocity);
  turning_ = p.mass[0] / (dt * dt) * (free - p.x - dt * p.v);
  system_.external_forces += turning_;
}

void RigidModel::after_solver(Body&, double dt) {
  Particles& p = particles();
  const double mass = p.mass[0];
  const Eigen::Vector3d before = angular_momentum(p, p.x_start, p.v_start);
  const Eigen::Vector3d center = p.x.rowwise().mean();
  const RigidShape::Corners offsets = p.x.colwise() - center;
  // m (x − x_start − h v_start) / h² are the forces of the step; those of the free rotation leave
  // the angular momentum as it is, and those of the cluster have none about the centre.
  const RigidShape::Corners forces =
      mass / (dt * dt) * (p.x - p.x_start - dt * p.v_start) - turning_;
  // Velocities beyond those of the displacements are impulses that the solver gave at the step's
  // end.
  const RigidShape::Corners given = p.v - (p.x - p.x_start) / dt;
  Eigen::Vector3d momentum = before;
  for (int i = 0; i < 4; ++i) {
    momentum += offsets.col(i).cross(dt * forces.col(i) + mass * given.col(i));
  }
  const Eigen::Vector3d velocity =
      (center - p.x_start.rowwise().mean()) / dt + given.rowwise().mean();
  const Eigen::Matrix3d end = axes();
  const RigidShape::Corners from_center = system_.shape.arms(end);
  const Eigen::Vector3d turn =
      end * moments_.cwiseInverse().asDiagonal() * end.transpose() * momentum;
  for (int i = 0; i < 4; ++i) {
    p.x.col(i) = center + from_center.col(i);
    p.v.col(i) = velocity + turn.cross(from_center.col(i));
  }
}

ModelRegistry::Entry rigid_entry() {
  return {"rigid",
          "rigid bodies that move freely: mugs, trays, boxes",
          {positive_parameter("density", "kg/m^3", "1000", 1e6, "mass per volume"),
           number_parameter("mass", "kg", "0", 0.0, 1e9, "of the body; 0: by its density")},
          {"rigid"},
          [](const Parameters& parameters, const BodyGeometry& geometry) {
            return std::make_unique<RigidModel>(
                geometry,
                RigidModel::Material{parameters.number("density"), parameters.number("mass")});
          }};
}

}  // namespace pliant
